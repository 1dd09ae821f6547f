"""Landing on a marked pad with little energy."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.control.velocity_limits import approach_speed, stopping_speed
from missionkit.geometry import vec
from missionkit.messages import Estimate, Goal, Guidance, Step, Target
from missionkit.planning.pad_view import ViewCone, deviation_height, entry_radius
from missionkit.plugin import Behavior
from missionkit.units import Degrees, Metres, MetresPerSecond, MetresPerSecond2, Number, Seconds

if TYPE_CHECKING:
    from missionkit.planning.energy_optimal import LandingPath

FOLLOW = 1.5  # 1/s, of an error of height
LEAD = 0.2  # s, level, the vehicle answers so late
SINKING = 0.4  # s, the same of its rate of descent
FALLING = 0.7  # m/s, about the mean rate on the last stretch
NEAR = 0.5  # m, level: the controller's own gains take it to the pad from here
RISE = 0.5  # s, by which the speed asked for is ahead while it accelerates
CLOSING = 2.4  # 1/s, of the level distance left
BRAKING = 0.8  # of the acceleration: the rest is for corrections
CLIMB = 0.5  # m/s, to see more of the ground
UNSEEN = "pad.unseen"
OVER = "pad.below"


class OnTheWay(NamedTuple):
    """Memory of `precision_land`: the path as it was planned, and what came of it."""

    yaw: float  # rad, nose to the pad
    left: tuple[float, ...]  # m, growing: level distances along the path
    height: tuple[float, ...]  # m, above the pad, at those
    descent: tuple[float, ...]  # m/s, at those
    top_speed: float  # m/s, level
    waits_since: float | None = None  # s, when it stood where the pad should be in view
    said: bool = False  # the event was raised


class PrecisionLand(Behavior):
    """Land on `target`, a pad with markers, along the path that takes the least energy.

    The path is planned once, on entry (`energy_optimal`: sideways as fast as allowed, down late,
    for the vehicle's `mass`, `drag` and rotors), and followed by the distance that is left. The
    three phases are for states of the chart:

    - `glide` follows it. As long as the pad is out of sight it stays above

          h_1 = max(k σ / tan φ,  v_d (0.3 s + 2 sqrt(k σ / a)),  h_min)

      with σ the present uncertainty of the pad relative to the vehicle, k `sigmas`, φ `half_angle`
      of the cone that the camera is sure to see, v_d `descent` and h_min `least`.
    - `deviate` leaves it for that height: it passes the cone's edge h_1 tan φ - k σ not below h_1,
      stands over the pad there, in sight or not, and raises `pad.below`. After `patience` without a
      sighting it climbs at 0.5 m/s, at most to `highest`, to see more ground, and raises
      `pad.unseen` when it has waited there as well.
    - `descend` goes down on the pad and corrects on the way. It does not sink while the pad has
      been out of sight for `blind`, except below `dark`, where the camera sees too little of it.

    A miss of more than `aside` is corrected `hover` above the pad. Below that it does not stop:
    optical flow is blind so low, and a vehicle that hovers there drifts away unnoticed. Done
    `hand_over` above the pad: the autopilot lands from there. With `sigmas` 0 the estimate is
    trusted as it is, and `glide` goes down without having seen the pad.

    Source: P3 section VI-B, correction P3.6.
    """

    kind: ClassVar[str] = "precision_land"
    target: str
    phase: Literal["glide", "deviate", "descend"] = Field(
        default="glide", description="part of the landing that the state flies"
    )
    half_angle_deg: Degrees = Field(
        default=25.0, gt=0, lt=80, description="of the cone below that the camera is sure to see"
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
        north, east, height = (target.position - seen.position).tolist()
        left = math.hypot(north, east)
        goal = Goal(target.position, None, seen.now, self.target)
        if height <= self.hand_over:
            return Step(done=True, goal=goal, note="handing over", memory=on)
        if self.phase == "deviate":
            return self._looking(seen, target, (left, height), on, goal)
        floor, note = self._floor(seen, target, height)
        rate = self._rate(seen, (left, height), on, floor)
        return self._towards(seen, target, rate, on, goal, note)

    @override
    def targets(self) -> tuple[str, ...]:
        return (self.target,)

    @property
    def _cone(self) -> ViewCone:
        half_angle = math.radians(self.half_angle_deg)
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
        left_over, heights, rates = (
            tuple(column[::-1].tolist()) for column in (path.left, path.height, path.descent)
        )
        return OnTheWay(yaw, left_over, heights, rates, path.top_speed)

    def _path(self, left: float, height: float, closing: float, sd: float) -> LandingPath:
        """Plan a path over `left` (m) and down `height` (m), the pad known to `sd` (m)."""
        from missionkit.planning.energy_optimal import (  # noqa: PLC0415 - compiles kernels
            NO_GATE,
            Airframe,
            Gate,
            LandingLimits,
            plan,
        )
        from missionkit.planning.rotor_power import RotorPower  # noqa: PLC0415

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
        airframe = Airframe(self.mass, self.drag, RotorPower().model())
        return plan(left, height, airframe, limits, gate, closing)

    def _in_view(self, seen: Estimate, target: Target) -> bool:
        return target.seen_at is not None and seen.now - target.seen_at <= self.blind

    def _floor(self, seen: Estimate, target: Target, height: float) -> tuple[float, str]:
        """Return the height (m) above the pad not to go below now, and why."""
        wide = _missing(seen, target, height / FALLING) > self.aside
        lowest = self.hover if wide and height > self.hover else 0.0
        if self.sigmas == 0.0 or self._in_view(seen, target):
            return lowest, ""
        if self.phase == "descend" and height <= self.dark:
            return lowest, ""
        if self.phase == "descend":
            return height, f"waiting for {self.target}"
        return deviation_height(self._cone, target.position_sd), f"{self.target} is not in view yet"

    def _rate(self, seen: Estimate, at: tuple[float, float], on: OnTheWay, floor: float) -> float:
        """Return the rate of descent (m/s) that keeps to the path and stops above `floor` (m)."""
        left, height = at
        ahead = left - SINKING * math.hypot(seen.velocity[0], seen.velocity[1])
        wanted = max(floor, _interpolated(on.left, on.height, ahead))
        steady = _interpolated(on.left, on.descent, ahead) if wanted > floor else 0.0
        if ahead <= self.aside:
            wanted, steady = floor, self.descent
        gap = height - floor
        a = self.vertical_acceleration
        stopping = stopping_speed(gap, a, SINKING) if gap > 0.0 else 0.0
        rate = min(steady + FOLLOW * (height - wanted), self.descent, stopping)
        least = self.touch_down if floor <= 0.0 else 0.0
        return max(rate, -CLIMB) if gap < 0.0 else max(least, rate)

    def _looking(
        self, seen: Estimate, target: Target, at: tuple[float, float], on: OnTheWay, goal: Goal
    ) -> Step:
        """Fly to where the pad is sure to be in view, and higher if it is not."""
        left = at[0]
        cone, sd = self._cone, target.position_sd
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
        rate = self._rate(seen, at, on, high)
        note = f"looking for {self.target}" if hidden else f"{self.target} in view"
        return self._towards(seen, target, rate, on, goal, note)._replace(events=events)

    def _towards(
        self, seen: Estimate, target: Target, rate: float, on: OnTheWay, goal: Goal, note: str
    ) -> Step:
        """Fly level to the pad: as fast as braking allows from afar, by the controller near it."""
        top = math.hypot(on.top_speed, self.descent)
        north, east, _ = (target.position - seen.position).tolist()
        left = math.hypot(north, east)
        if left <= NEAR:
            place = vec(target.position[0], target.position[1], seen.position[2])
            guidance = Guidance(place, top, vec(0.0, 0.0, rate), yaw=on.yaw, avoid=False)
        else:
            along = (seen.velocity[0] * north + seen.velocity[1] * east) / left
            rising = max(0.0, float(along)) + RISE * self.acceleration
            speed = min(rising, _braking_speed(left, on.top_speed, BRAKING * self.acceleration))
            velocity = vec(speed * north / left, speed * east / left, rate)
            guidance = Guidance(seen.position, top, velocity, yaw=on.yaw, avoid=False)
        return Step(guidance, goal=goal, note=note, memory=on)


def _missing(seen: Estimate, target: Target, within: float) -> float:
    """Return how far (m, level) from the pad it will be in so many seconds if it comes to rest."""
    north, east, _ = (target.position - seen.position - 0.5 * within * seen.velocity).tolist()
    return math.hypot(north, east)


def _braking_speed(left: float, top: float, braking: float) -> float:
    """Return the level speed (m/s) to ask for at a distance (m) left, for its lag.

    v - a t where it brakes along v = sqrt(2 a d): it answers a falling command that much late.
    """
    speed = approach_speed(left, CLOSING, braking)
    return top if speed >= top else max(0.0, speed - LEAD * min(braking, CLOSING * speed))


def _interpolated(xs: tuple[float, ...], ys: tuple[float, ...], x: float) -> float:
    """Return y at x, of points in the order of growing x; the last of those at one place counts.

    Before the first and behind the last it is that of the end.
    """
    if x <= xs[0]:
        return ys[0]
    for n in range(1, len(xs)):
        if x < xs[n]:
            share = (x - xs[n - 1]) / (xs[n] - xs[n - 1])
            return ys[n - 1] + share * (ys[n] - ys[n - 1])
    return ys[-1]
