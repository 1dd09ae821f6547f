"""Landing on a marked pad by sight."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, Self

from pydantic import Field, model_validator
from typing_extensions import override

from missionkit.behaviors.pad_guidance import (
    CLIMB,
    PadLimits,
    PadView,
    towards,
    view_of,
    would_miss,
)
from missionkit.messages import (
    Action,
    CameraModel,
    Estimate,
    Goal,
    Guidance,
    LandingTarget,
    Step,
    Target,
)
from missionkit.planning.pad_view import ViewCone, cone_below, deviation_height, entry_radius
from missionkit.planning.rotor_power import RotorPower
from missionkit.plugin import Behavior
from missionkit.units import Degrees, Metres, MetresPerSecond, MetresPerSecond2, Number, Seconds

if TYPE_CHECKING:
    from missionkit.planning.energy_optimal import LandingPath

LEAST, MOST = 1.0, 79.0  # deg, of a cone: a camera that does not see straight down sees almost none
MOVING = 0.1  # m/s, a faster pad is flown along with until the autopilot reports contact
COMMITTED = 0.2  # m, lower, it comes down whatever happens
FOLLOWED = 3.0  # s without a sighting, for which a moving pad is taken to move on as it did
CLOSING, SPARING = 2.0, 3.0  # 1/s: satellites' noise makes a quicker one overshoot
UNSEEN = "pad.unseen"
OVER = "pad.below"
ABORTED = "pad.aborted"
GIVEN_UP = "pad.given_up"


class OnTheWay(NamedTuple):
    """Memory of `land_on`: the path as it was planned, and what came of it."""

    yaw: float  # rad, nose to the pad
    top_speed: float  # m/s, level
    descent: float  # m/s
    waits_since: float | None = None  # s, when it stood where the pad should be in view
    said: bool = False  # the event was raised
    down: bool = False  # phase `all`: coming down
    aborts: int = 0
    keep: float = 0.0  # m above the pad, after an abort, until the pad is in view again


class LandOn(Behavior):
    """Land on `target`, a pad with markers, by sight, and try again if that fails.

    Markers of several sizes and places are one target: each is an entry of `perception` with its
    `offset`, the large ones for afar, the small ones for the last metre. The pad may lean, and it
    may move if `navigation` says so (`moving: {pad: 1.0}`); its velocity is added to what is flown.
    In the phase `all`

    1. it flies level to the pad, and stays above

           h_1 = max(k σ / tan φ,  v_d (0.3 s + 2 sqrt(k σ / a)),  h_min)

       until the pad is in view, with σ the present uncertainty of the pad relative to the vehicle,
       k `sigmas`, φ the half angle of the cone below that the mission's camera sees of a level
       vehicle, or `half_angle_deg`, v_d `descent` and h_min `least`. Over the pad's place without
       a sighting for `patience` it climbs at 0.5 m/s, at most to `highest`, and raises
       `pad.unseen` when it has waited there as well.
    2. It comes down as fast as its sideways error allows, and only while that is at most `aside`
       plus the height times tan `centred_deg`; else it waits at its height.
    3. The pad out of sight for `patience`, or below `dark`, where the camera sees too little of it,
       for `blind_for`, or more than twice `aside` off below `hover`: it climbs by 1 m, raises
       `pad.aborted` and goes on at 1. After `retries` of that it raises `pad.given_up` and stays
       up. Below 0.2 m it does not turn back.
    4. Done `hand_over` above a pad that stands still: the autopilot lands from there. With a pad
       that moves it flies on until the autopilot reports contact.

    With `by: autopilot` the vehicle's own precision landing flies 2 and 4: once the pad is in view
    and below, it gets LANDING_TARGET at every tick while the pad is in view (10 Hz or more with
    `settings: {rate: 10}` or more), and is done when it stands disarmed. PX4 lands so in its mode
    PRECLAND; ArduPilot in LAND, if its parameters PLND_ENABLED and PLND_TYPE are 1. Out of view for
    `patience` above `dark`, missionkit takes over, climbs, and goes on as in 3.

    The other phases are the parts of P3's landing with little energy, for states of a chart. The
    path is planned once, on entry (`energy_optimal`: sideways as fast as allowed, down late, for
    the vehicle's `mass`, `drag` and `rotors`). Its level speed and its rate of descent are flown;
    the height follows from the time that the level distance left still takes.

    - `glide` follows it, above h_1 as long as the pad is out of sight.
    - `deviate` leaves it for h_1: it passes the cone's edge h_1 tan φ - k σ not below h_1, stands
      over the pad there, in sight or not, and raises `pad.below`; without a sighting as in 1.
    - `descend` goes down on the pad and corrects on the way. Below h_1 it does not sink while the
      pad has been out of sight for `blind`, except below `dark`.

    If it would miss by more than `aside` it stays `hover` above the pad. Below that it does not
    stop in these phases: optical flow is blind so low, and a vehicle that hovers there drifts away
    unnoticed. With `sigmas` 0 the estimate is trusted as it is, and `glide` goes down without
    having seen the pad. `control: {observer: {}}` belongs to it: without it what the autopilot's
    integral holds after braking is a miss.

    Source: P3 section VI-B, correction P3.6.
    """

    kind: ClassVar[str] = "land_on"
    target: str
    phase: Literal["all", "glide", "deviate", "descend"] = Field(
        default="all", description="part of the landing that the state flies"
    )
    by: Literal["missionkit", "autopilot"] = Field(
        default="missionkit", description="who flies the last part, from where the pad is in view"
    )
    half_angle_deg: Degrees | None = Field(
        default=None, gt=0, lt=80, description="of the cone below in view; else by the camera"
    )
    sigmas: Number = Field(default=2.0, ge=0, description="of the pad's place, allowed for")
    least: Metres = Field(default=0.6, ge=0, description="height until the pad is in view")
    speed: MetresPerSecond = Field(default=8.0, gt=0)
    acceleration: MetresPerSecond2 = Field(default=2.5, gt=0, description="level, braking too")
    descent: MetresPerSecond = Field(default=1.5, gt=0)
    vertical_acceleration: MetresPerSecond2 = Field(default=2.0, gt=0)
    touch_down: MetresPerSecond = Field(default=0.4, gt=0)
    hand_over: Metres = Field(default=0.12, gt=0, description="the autopilot lands from here")
    hover: Metres = Field(
        default=0.45, gt=0, description="no lower while it is not over the pad; below, no stop"
    )
    aside: Metres = Field(default=0.1, gt=0, description="level distance that is over the pad")
    blind: Seconds = Field(default=0.5, gt=0)
    dark: Metres = Field(default=0.6, ge=0, description="lower, the pad may be out of view")
    patience: Seconds = Field(default=1.5, ge=0)
    highest: Metres = Field(default=6.0, gt=0)
    centred_deg: Degrees = Field(
        default=8.0, ge=0, le=45, description="it comes down within so much of straight below"
    )
    blind_for: Seconds = Field(default=2.0, ge=0, description="below `dark`, at most")
    retries: int = Field(default=3, ge=0, le=100, description="after an abort")
    mass: Number = Field(default=1.2, gt=0, description="kg")
    drag: Number = Field(default=0.0118, ge=0, description="N/(m/s)²")
    rotors: RotorPower | None = Field(
        default=None, description="as in a world file; else 9-inch ones"
    )

    @model_validator(mode="after")
    def _whole_landing(self) -> Self:
        if self.by == "autopilot" and self.phase != "all":
            raise ValueError("'by: autopilot' belongs to the phase 'all'")
        return self

    @override
    def begin(self, seen: Estimate) -> OnTheWay | None:
        target = seen.targets.get(self.target)
        return None if target is None else self._planned(seen, target)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        target = seen.targets.get(self.target)
        on: OnTheWay | None = memory
        if target is None:
            return Step(note=f"where {self.target} is, is not known", memory=on)
        if on is None:
            on = self._planned(seen, target)
        view = view_of(seen, target)
        if self.by == "autopilot":
            return self._by_autopilot(seen, target, view, on)
        if self._arrived(seen, view):
            goal = Goal(target.position, None, seen.now, self.target)
            return Step(done=True, goal=goal, note="handing over", memory=on, lands=True)
        if self.phase == "all":
            return self._landing(seen, target, view, on)
        if self.phase == "deviate":
            return self._looking(seen, target, view, on)
        floor, note = self._floor(seen, target, view, on)
        return self._towards(seen, target, view, on, floor, note)

    def _arrived(self, seen: Estimate, view: PadView) -> bool:
        """Say whether the autopilot may land from here, or has landed on a pad that moves."""
        down = seen.status is not None and not seen.status.in_air
        if self.phase == "all" and math.hypot(*view.pad_velocity[:2].tolist()) > MOVING:
            return down and view.height <= self.hover
        return view.height <= self.hand_over

    def _landing(self, seen: Estimate, target: Target, view: PadView, on: OnTheWay) -> Step:
        """Fly the whole landing: look for the pad, come down on it, or turn back."""
        unseen_for = math.inf if target.seen_at is None else seen.now - target.seen_at
        if not on.down:
            if on.aborts <= self.retries and unseen_for <= self.blind:
                on = on._replace(down=True, waits_since=None, said=False, keep=0.0)
            else:
                return self._looking(seen, target, view, on)
        if why := self._turns_back(view, unseen_for):
            return self._aborted(seen, target, view, on, why)
        floor = 0.0
        note = ""
        if view.height > self.hover and not self._centred(view, on):
            floor, note = max(self.hover, view.height), f"not over {self.target} yet"
        elif view.height > self.dark and unseen_for > self.blind:
            floor, note = view.height, f"waiting for {self.target}"
        return self._towards(seen, target, view, on, floor, note)

    def _by_autopilot(self, seen: Estimate, target: Target, view: PadView, on: OnTheWay) -> Step:
        """Bring the vehicle over the pad, and let the autopilot land on it."""
        status = seen.status
        goal = Goal(target.position, None, seen.now, self.target)
        if on.down and status is not None and not status.in_air and not status.armed:
            return Step(done=True, goal=goal, note="landed", memory=on, lands=True)
        unseen_for = math.inf if target.seen_at is None else seen.now - target.seen_at
        fresh = unseen_for <= self.blind
        if not on.down:
            over = view.level <= self.aside + view.height * math.tan(math.radians(self.centred_deg))
            if not (fresh and over and on.aborts <= self.retries):
                return self._looking(seen, target, view, on)
            on = on._replace(down=True, waits_since=None, said=False, keep=0.0)
        in_air = status is None or status.in_air
        if in_air and view.height > self.dark and unseen_for > self.patience:
            why = f"{self.target} out of sight for {unseen_for:.1f} s"
            return self._aborted(seen, target, view, on, why)
        told = None
        if fresh:
            told = LandingTarget(self.target, target.position - seen.position)
        note = f"the autopilot lands on {self.target}"
        return Step(
            action=Action.PRECISION_LAND,
            goal=goal,
            note=note,
            memory=on,
            lands=True,
            landing_target=told,
        )

    def _centred(self, view: PadView, on: OnTheWay) -> bool:
        near = self.aside + view.height * math.tan(math.radians(self.centred_deg))
        missing = would_miss(view, self._limits(on), self.aside)
        return view.level <= near and not (missing and view.height <= 2.0 * self.hover)

    def _turns_back(self, view: PadView, unseen_for: float) -> str:
        """Return why the descent is given up, empty if it is not."""
        if view.height <= COMMITTED:
            return ""
        if view.height <= self.dark:
            if unseen_for > self.blind_for:
                return f"{self.target} out of sight for {unseen_for:.1f} s near the ground"
            if view.height < self.hover and view.level > 2.0 * self.aside:
                return f"{view.level:.2f} m off {self.target} near the ground"
            return ""
        return f"{self.target} out of sight for {unseen_for:.1f} s" * (unseen_for > self.patience)

    def _aborted(
        self, seen: Estimate, target: Target, view: PadView, on: OnTheWay, why: str
    ) -> Step:
        """Begin to climb; the last time say that it is given up."""
        keep = min(max(view.height + 1.0, self.least), max(self.highest, view.height))
        on = on._replace(down=False, aborts=on.aborts + 1, keep=keep, waits_since=seen.now)
        over = on.aborts > self.retries
        step = self._looking(seen, target, view, on)
        event = GIVEN_UP if over else ABORTED
        note = f"{why}: attempt {on.aborts} of {self.retries + 1} is over"
        return step._replace(events=(event,), note=note)

    @override
    def targets(self) -> tuple[str, ...]:
        return (self.target,)

    @override
    def with_camera(self, camera: CameraModel) -> Self:
        if self.half_angle_deg is not None:
            return self
        below = min(MOST, math.degrees(cone_below(camera)))
        return self.model_copy(update={"half_angle_deg": max(LEAST, below)})

    @property
    def _cone(self) -> ViewCone:
        half_angle = math.radians(self.half_angle_deg or LEAST)
        return ViewCone(half_angle, self.sigmas, self.descent, self.acceleration, self.least)

    @override
    def warm_up(self) -> None:
        self._path(1.0, 1.0, 0.0, 0.1)

    def _planned(self, seen: Estimate, target: Target) -> OnTheWay:
        """Plan the path from where the vehicle is, and how it moves."""
        north, east, height = (target.position - seen.position).tolist()
        left = math.hypot(north, east)
        closing = 0.0
        if left > 0.0:
            closing = (seen.velocity[0] * north + seen.velocity[1] * east) / left
        path = self._path(left, height, closing, target.position_sd)
        yaw = math.atan2(east, north) if left > 1.0 else seen.yaw
        return OnTheWay(yaw, path.top_speed, float(path.descent.max()))

    def _path(self, left: float, height: float, closing: float, sd: float) -> LandingPath:
        """Plan a path over `left` (m) and down `height` (m), the pad known to `sd` (m)."""
        from missionkit.planning.energy_optimal import (  # noqa: PLC0415 - compiles kernels
            NO_GATE,
            Airframe,
            Gate,
            plan,
        )
        from missionkit.planning.landing_profiles import LandingLimits  # noqa: PLC0415

        gate = NO_GATE
        if self.phase == "deviate":
            high = deviation_height(self._cone, sd)
            gate = Gate(entry_radius(self._cone, sd, high), high)
        limits = LandingLimits(
            self.speed,
            self.acceleration,
            self.acceleration,
            self.descent,
            self.vertical_acceleration,
            self.touch_down,
        )
        airframe = Airframe(self.mass, self.drag, (self.rotors or RotorPower()).model())
        return plan(left, height, airframe, limits, gate, closing)

    def _in_view(self, seen: Estimate, target: Target) -> bool:
        return target.seen_at is not None and seen.now - target.seen_at <= self.blind

    def _limits(self, on: OnTheWay) -> PadLimits:
        return PadLimits(
            on.top_speed,
            self.acceleration,
            on.descent,
            self.vertical_acceleration,
            self.touch_down,
            CLOSING if self.phase == "all" else SPARING,
        )

    def _floor(
        self, seen: Estimate, target: Target, view: PadView, on: OnTheWay
    ) -> tuple[float, str]:
        """Return the height (m) above the pad not to go below now, and why."""
        height = view.height
        lowest = 0.0
        if height > self.hover and would_miss(view, self._limits(on), self.aside):
            lowest = self.hover
        if self.sigmas == 0.0 or self._in_view(seen, target):
            return lowest, ""
        high = deviation_height(self._cone, target.position_sd)
        if self.phase != "descend":
            return high, f"{self.target} is not in view yet"
        if height <= self.dark:
            return lowest, ""
        return min(height, high), f"waiting for {self.target}"

    def _looking(self, seen: Estimate, target: Target, view: PadView, on: OnTheWay) -> Step:
        """Fly to where the pad is sure to be in view, and higher if it is not."""
        cone, sd = self._cone, target.position_sd
        high = max(deviation_height(cone, sd), on.keep)
        near = view.level <= max(self.aside, entry_radius(cone, sd, high))
        if near and on.waits_since is None:
            on = on._replace(waits_since=seen.now)
        waited = 0.0 if on.waits_since is None else seen.now - on.waits_since
        hidden = not self._in_view(seen, target)
        if hidden and waited > self.patience:
            high = min(max(high, self.highest), high + CLIMB * (waited - self.patience))
        events: tuple[str, ...] = ()
        if near and not on.said and not hidden:
            events, on = (OVER,), on._replace(said=True)
        late = waited > 2.0 * self.patience + max(0.0, self.highest - self.least) / CLIMB
        if hidden and late and not on.said:
            events, on = (UNSEEN,), on._replace(said=True)
        note = f"looking for {self.target}" if hidden else f"{self.target} in view"
        return self._towards(seen, target, view, on, high, note)._replace(events=events)

    def _towards(
        self, seen: Estimate, target: Target, view: PadView, on: OnTheWay, floor: float, note: str
    ) -> Step:
        """Fly to the pad, down no lower than `floor` (m) above it."""
        unseen_for = 0.0 if target.seen_at is None else seen.now - target.seen_at
        if unseen_for > FOLLOWED:  # where it has gone since is not known
            view = view._replace(velocity=seen.velocity, pad_velocity=0.0 * view.pad_velocity)
        velocity = towards(view, self._limits(on), floor)
        top = math.hypot(self.speed, self.descent)
        if target.velocity is not None:
            top += math.hypot(*target.velocity[:2].tolist())
        guidance = Guidance(seen.position, top, velocity, yaw=on.yaw, avoid=False)
        goal = Goal(target.position, None, seen.now, self.target)
        lands = view.height <= self.dark
        return Step(guidance, goal=goal, note=note, memory=on, lands=lands)
