"""Landing on a marked pad with little energy."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, Self

from pydantic import Field
from typing_extensions import override

from missionkit.control.landing_profile import (
    Closing,
    Descent,
    DescentState,
    closing_speed,
    closing_time,
    descent_time,
    height_before,
)
from missionkit.control.velocity_limits import stopping_speed
from missionkit.geometry import vec
from missionkit.messages import CameraModel, Estimate, Goal, Guidance, Step, Target
from missionkit.planning.pad_view import ViewCone, cone_below, deviation_height, entry_radius
from missionkit.planning.rotor_power import RotorPower
from missionkit.plugin import Behavior
from missionkit.units import Degrees, Metres, MetresPerSecond, MetresPerSecond2, Number, Seconds

if TYPE_CHECKING:
    from missionkit.planning.energy_optimal import LandingPath

CLOSING = 3.0  # 1/s, of the level distance left
ARRIVING = 2.0  # 1/s, the same as it is flown in the end, with all lags
BRAKING = 1.16  # of the acceleration: it answers late and brakes less than it is asked to
LEAD = 0.33  # s, level, it answers so late
DAMPING = 0.16  # s, of the braking wanted, taken off the speed sent
RISE = 0.75  # s, by which the speed sent is ahead while it accelerates
FOLLOW = 2.0  # 1/s, of an error of height
SINKING = 0.2  # s, its rate of descent answers so late
SLOWING = 0.25  # s, of the slowing wanted, taken off the rate sent
LEAST, MOST = 1.0, 79.0  # deg, of a cone: a camera that does not see straight down sees almost none
ARRIVED = 0.03  # m, level, it is over the pad
CLIMB = 0.5  # m/s, to see more of the ground
UNSEEN = "pad.unseen"
OVER = "pad.below"


class OnTheWay(NamedTuple):
    """Memory of `precision_land`: the path as it was planned, and what came of it."""

    yaw: float  # rad, nose to the pad
    top_speed: float  # m/s, level
    descent: float  # m/s
    waits_since: float | None = None  # s, when it stood where the pad should be in view
    said: bool = False  # the event was raised


class PrecisionLand(Behavior):
    """Land on `target`, a pad with markers, along the path that takes the least energy.

    The path is planned once, on entry (`energy_optimal`: sideways as fast as allowed, down late,
    for the vehicle's `mass`, `drag` and `rotors`). Its level speed and its rate of descent are
    flown; the height follows from the time that the level distance left still takes, so that it
    comes down as fast as its sideways error allows. The three phases are for states of the chart:

    - `glide` follows it. As long as the pad is out of sight it stays above

          h_1 = max(k σ / tan φ,  v_d (0.3 s + 2 sqrt(k σ / a)),  h_min)

      with σ the present uncertainty of the pad relative to the vehicle, k `sigmas`, φ the half
      angle of the cone below that the mission's camera sees of a level vehicle, or
      `half_angle_deg`, v_d `descent` and h_min `least`.
    - `deviate` leaves it for that height: it passes the cone's edge h_1 tan φ - k σ not below h_1,
      stands over the pad there, in sight or not, and raises `pad.below`. After `patience` without a
      sighting it climbs at 0.5 m/s, at most to `highest`, to see more ground, and raises
      `pad.unseen` when it has waited there as well.
    - `descend` goes down on the pad and corrects on the way. Below h_1 it does not sink while the
      pad has been out of sight for `blind`, except below `dark`, where the camera sees too little.

    If it would miss by more than `aside` it stays `hover` above the pad. Below that it does not
    stop: optical flow is blind so low, and a vehicle that hovers there drifts away unnoticed. Done
    `hand_over` above the pad: the autopilot lands from there. With `sigmas` 0 the estimate is
    trusted as it is, and `glide` goes down without having seen the pad. `control: {observer: {}}`
    belongs to it: without it what the autopilot's integral holds after braking is a miss.

    Source: P3 section VI-B, correction P3.6.
    """

    kind: ClassVar[str] = "precision_land"
    target: str
    phase: Literal["glide", "deviate", "descend"] = Field(
        default="glide", description="part of the landing that the state flies"
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
    mass: Number = Field(default=1.2, gt=0, description="kg")
    drag: Number = Field(default=0.0118, ge=0, description="N/(m/s)²")
    rotors: RotorPower | None = Field(
        default=None, description="as in a world file; else 9-inch ones"
    )

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
        height = float(target.position[2] - seen.position[2])
        if height <= self.hand_over:
            goal = Goal(target.position, None, seen.now, self.target)
            return Step(done=True, goal=goal, note="handing over", memory=on)
        if self.phase == "deviate":
            return self._looking(seen, target, on)
        floor, note = self._floor(seen, target, on)
        return self._towards(seen, target, on, floor, note)

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

    def _descent(self, rate: float) -> Descent:
        return Descent(max(rate, self.touch_down), self.vertical_acceleration, self.touch_down)

    def _floor(self, seen: Estimate, target: Target, on: OnTheWay) -> tuple[float, str]:
        """Return the height (m) above the pad not to go below now, and why."""
        height = float(target.position[2] - seen.position[2])
        lowest = 0.0
        if height > self.hover:
            late = self._time_to_pad(seen, target, on, self.aside)
            lowest = self.hover if late > descent_time(self._descent(on.descent), height) else 0.0
        if self.sigmas == 0.0 or self._in_view(seen, target):
            return lowest, ""
        high = deviation_height(self._cone, target.position_sd)
        if self.phase != "descend":
            return high, f"{self.target} is not in view yet"
        if height <= self.dark:
            return lowest, ""
        return min(height, high), f"waiting for {self.target}"

    def _time_to_pad(self, seen: Estimate, target: Target, on: OnTheWay, within: float) -> float:
        """Return the time (s) until the vehicle is within so much (m, level) of the pad."""
        north, east, _ = (target.position - seen.position).tolist()
        speed = math.hypot(seen.velocity[0], seen.velocity[1])
        flown = Closing(ARRIVING, BRAKING * self.acceleration, on.top_speed)
        return closing_time(flown, math.hypot(north, east), speed, within)

    def _rate(self, seen: Estimate, target: Target, on: OnTheWay, floor: float) -> float:
        """Return the rate of descent (m/s) that ends over the pad and stops above `floor` (m)."""
        height, sinking = float(target.position[2] - seen.position[2]), float(seen.velocity[2])
        time = self._time_to_pad(seen, target, on, ARRIVED) - SINKING
        wanted = height_before(self._descent(on.descent), time, sinking)
        if wanted.height <= floor:
            wanted = DescentState(floor, 0.0, 0.0)
        ahead = height - SINKING * sinking
        rate = min(wanted.rate + FOLLOW * (ahead - wanted.height), on.descent)
        rate -= SLOWING * wanted.slowing
        if floor <= 0.0:
            return max(self.touch_down, rate)
        if height <= floor:
            return max(rate, -CLIMB)
        late = SINKING + SLOWING
        return max(0.0, min(rate, stopping_speed(height - floor, self.vertical_acceleration, late)))

    def _looking(self, seen: Estimate, target: Target, on: OnTheWay) -> Step:
        """Fly to where the pad is sure to be in view, and higher if it is not."""
        cone, sd = self._cone, target.position_sd
        left = math.hypot(*(target.position - seen.position)[:2].tolist())
        high = deviation_height(cone, sd)
        near = left <= max(self.aside, entry_radius(cone, sd, high))
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
        return self._towards(seen, target, on, high, note)._replace(events=events)

    def _towards(
        self, seen: Estimate, target: Target, on: OnTheWay, floor: float, note: str
    ) -> Step:
        """Fly level to the pad, as fast as braking allows, and down no lower than `floor` (m).

        What is sent is the speed of the profile where the vehicle will be when it answers, less a
        share of the braking v dv/dx that the profile asks for.
        """
        north, east, _ = (target.position - seen.position - LEAD * seen.velocity).tolist()
        left = max(1e-9, math.hypot(north, east))
        vn, ve, _ = seen.velocity.tolist()
        along = (vn * north + ve * east) / left
        braking = BRAKING * self.acceleration
        speed, slope = closing_speed(Closing(CLOSING, braking, on.top_speed), left)
        speed = min(speed, max(0.0, along) + RISE * self.acceleration)
        damping = DAMPING * slope
        velocity = vec(
            speed * north / left - damping * vn,
            speed * east / left - damping * ve,
            self._rate(seen, target, on, floor),
        )
        top = math.hypot(self.speed, self.descent)
        guidance = Guidance(seen.position, top, velocity, yaw=on.yaw, avoid=False)
        goal = Goal(target.position, None, seen.now, self.target)
        return Step(guidance, goal=goal, note=note, memory=on)
