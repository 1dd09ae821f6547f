"""Circles round a target."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Literal, NamedTuple, Self

from pydantic import Field, model_validator
from typing_extensions import override

from missionkit.behaviors.go_to import HOME
from missionkit.behaviors.route_flight import bearing
from missionkit.geometry import Vec3, vec, wrap
from missionkit.messages import Estimate, Goal, Guidance, Step
from missionkit.planning.route_following import CLIMB, DESCENT, LAG, Triple, absent
from missionkit.plugin import Behavior
from missionkit.units import Metres, MetresPerSecond, Number, Seconds

ON_CIRCLE = 1.0  # m, from the circle, that counts as being on it
CENTRIPETAL = 1.5  # m/s², at most: a smaller circle is flown more slowly
YAW_LAG = 0.65  # s, by which the nose follows late where it turns steadily: 1/gain of the yaw law
MOST_TURNS = 500
BACK = 3.0  # m, ahead on the circle, on the way back to where it was interrupted
CORNERS = 24  # of the polygon that checks take for a circle


class OnOrbit(NamedTuple):
    """Memory of `orbit`."""

    down: float  # m, NED, when it began
    bearing: float  # rad, from the target to the vehicle
    swept: float = 0.0  # rad, so far
    since: float | None = None  # s, when it came to the circle first; later by what does not count
    at: float = 0.0  # s, of the last step
    returning: bool = False  # to where it was interrupted


class Orbit(Behavior):
    """Fly round `target` at `radius`, looking at it; done after `turns`, or `seconds`.

    The vehicle flies straight to the nearest point of the circle, and then round it, `clockwise`
    as seen from above or not. With `to_height` it climbs or descends evenly from `height` (or the
    height that it began with) while it goes round, as along a tower; a turn then rises by
    (to_height - height) / turns. `look` says whether the nose points at the target, away from it or
    along the circle. Without `turns` and `seconds` it goes on until something else ends it. After
    a pause it first returns to where it was interrupted: to the circle, and round it the shorter
    way; that counts neither as turns nor as seconds.

        v <= speed,  v² / radius <= 1.5 m/s²

    and no faster than it can climb (2 m/s) or descend (1.2 m/s) on the way.

    Limits: a target that moves is followed, up to what `speed` leaves; `avoid` pushes the vehicle
    outwards where the target itself is an obstacle nearer than its reach.
    """

    kind: ClassVar[str] = "orbit"
    target: str
    radius: Metres = Field(default=8.0, gt=0)
    speed: MetresPerSecond = Field(default=2.0, gt=0)
    turns: Number | None = Field(
        default=None, gt=0, le=MOST_TURNS, description="after which it is done"
    )
    seconds: Seconds | None = Field(default=None, gt=0, description="on the circle")
    clockwise: bool = Field(default=True, description="as seen from above")
    height: Metres | None = Field(default=None, description="above the take-off point")
    to_height: Metres | None = Field(default=None, description="at the end, above the same")
    look: Literal["inwards", "outwards", "course"] = Field(
        default="inwards", description="where the nose points"
    )

    @model_validator(mode="after")
    def _ends(self) -> Self:
        if self.turns is not None and self.seconds is not None:
            raise ValueError("give either turns or seconds")
        if self.to_height is not None and self.turns is None:
            raise ValueError("to_height needs turns: it says how many turns the climb takes")
        return self

    @property
    @override
    def endless(self) -> bool:
        return self.turns is None and self.seconds is None

    @override
    def begin(self, seen: Estimate) -> OnOrbit:
        centre = self._centre(seen)
        away = None if centre is None else bearing(centre, seen.position)
        first = seen.yaw + math.pi if away is None else away
        return OnOrbit(float(seen.position[2]), first, at=seen.now)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: OnOrbit = memory
        centre = self._centre(seen)
        if centre is None:
            return Step(note=f"the position of {self.target} is unknown", memory=on)
        away = bearing(centre, seen.position)
        at = on.bearing if away is None else away
        sense = 1.0 if self.clockwise else -1.0
        due = self._on_circle(centre, on.bearing, self._down(on))
        off = math.dist(seen.position, due) if on.since is not None else 0.0
        lost, returning = absent(on.at, seen.now, off, returning=on.returning)
        since = None if on.since is None else on.since + lost
        on = on._replace(at=seen.now, since=since, returning=returning)
        level = abs(math.dist(seen.position[:2], centre[:2]) - self.radius)
        if level > ON_CIRCLE and (on.since is None or returning):
            return self._to_circle(seen, centre, at, sense, on)
        if returning:
            return self._back(seen, centre, at, sense, on)
        turned = 0.0 if lost else sense * wrap(at - on.bearing)
        since = seen.now if since is None else since
        on = on._replace(bearing=at, swept=on.swept + turned, since=since)
        return self._round(seen, centre, on, sense, since)

    @override
    def targets(self) -> tuple[str, ...]:
        return () if self.target == HOME else (self.target,)

    @override
    def way(self, start: Triple, targets: Mapping[str, Triple]) -> tuple[Triple, ...]:
        centre = (0.0, 0.0, 0.0) if self.target == HOME else targets.get(self.target)
        if centre is None:
            return ()
        first = start[2] if self.height is None else -self.height
        last = first if self.to_height is None else -self.to_height
        at = math.atan2(start[1] - centre[1], start[0] - centre[0])
        count = math.ceil(CORNERS * max(1.0, self.turns or 1.0))
        whole = math.tau * (self.turns or 1.0) * (1.0 if self.clockwise else -1.0)
        found = []
        for share in (k / count for k in range(count + 1)):
            angle = at + whole * share
            north, east = self.radius * math.cos(angle), self.radius * math.sin(angle)
            found.append((centre[0] + north, centre[1] + east, first + share * (last - first)))
        return tuple(found)

    def _to_circle(
        self, seen: Estimate, centre: Vec3, at: float, sense: float, on: OnOrbit
    ) -> Step:
        """Fly to the nearest point of the circle."""
        if on.since is None:
            on = on._replace(bearing=at)
        spot = self._on_circle(centre, at, self._down(on))
        goal = Goal(spot, None, seen.now, self.target)
        guidance = Guidance(spot, self.speed, yaw=self._yaw(at, sense))
        return Step(guidance, goal=goal, note="flying to the circle", memory=on)

    def _back(self, seen: Estimate, centre: Vec3, at: float, sense: float, on: OnOrbit) -> Step:
        """Fly round the circle, the shorter way, to where it was interrupted."""
        off = wrap(on.bearing - at)
        ahead = at + math.copysign(min(abs(off), BACK / self.radius, 0.4), off)
        spot = self._on_circle(centre, ahead, self._down(on))
        guidance = Guidance(spot, self.speed, yaw=self._yaw(at, sense))
        goal = Goal(self._on_circle(centre, on.bearing, self._down(on)), None, seen.now)
        return Step(guidance, goal=goal, note="returning to where it was interrupted", memory=on)

    def _round(self, seen: Estimate, centre: Vec3, on: OnOrbit, sense: float, since: float) -> Step:
        """Go on round the circle."""
        speed = self._speed(on)
        rate = sense * speed / self.radius  # rad/s
        ahead = on.bearing + rate * LAG
        spot = self._on_circle(centre, on.bearing, self._down(on))
        velocity = speed * sense * vec(-math.sin(ahead), math.cos(ahead), 0.0)
        target = seen.targets.get(self.target)
        if target is not None and target.velocity is not None:
            velocity = velocity + target.velocity
        done, left = self._left(on, seen.now - since)
        if on.swept < self._whole:
            velocity[2] += self._sinking(on) * abs(rate)
        guidance = Guidance(
            spot, 1.5 * self.speed, velocity, self._yaw(on.bearing + rate * YAW_LAG, sense)
        )
        goal = Goal(spot, None, seen.now, self.target)
        return Step(guidance, done=done, goal=goal, note=left, memory=on)

    def _speed(self, on: OnOrbit) -> float:
        """Return the speed (m/s) along the circle at which neither turn nor climb is too steep."""
        speed = min(self.speed, math.sqrt(CENTRIPETAL * self.radius))
        sinking = self._sinking(on)
        if sinking == 0.0 or on.swept >= self._whole:
            return speed
        return min(speed, self.radius * (DESCENT if sinking > 0.0 else CLIMB) / abs(sinking))

    @property
    def _whole(self) -> float:
        return math.inf if self.turns is None else math.tau * self.turns

    def _left(self, on: OnOrbit, flown: float) -> tuple[bool, str]:
        if self.seconds is not None:
            return flown >= self.seconds, f"{max(0.0, self.seconds - flown):.0f} s left"
        turns = on.swept / math.tau
        if self.turns is None:
            return False, f"turn {turns:.1f}"
        return on.swept >= self._whole, f"turn {turns:.1f} of {self.turns:g}"

    def _down(self, on: OnOrbit) -> float:
        """Return how far down (m, NED) it should be by now."""
        first = on.down if self.height is None else -self.height
        if self.to_height is None:
            return first
        share = min(1.0, max(0.0, on.swept / self._whole))
        return first + share * (-self.to_height - first)

    def _sinking(self, on: OnOrbit) -> float:
        """Return how much further down (m) it goes for each radian."""
        if self.to_height is None:
            return 0.0
        first = on.down if self.height is None else -self.height
        return (-self.to_height - first) / self._whole

    def _on_circle(self, centre: Vec3, angle: float, down: float) -> Vec3:
        north, east = self.radius * math.cos(angle), self.radius * math.sin(angle)
        return vec(centre[0] + north, centre[1] + east, down)

    def _yaw(self, angle: float, sense: float) -> float:
        """Return the heading (rad) at a bearing from the target."""
        turn = {"inwards": math.pi, "outwards": 0.0, "course": sense * 0.5 * math.pi}
        return wrap(angle + turn[self.look])

    def _centre(self, seen: Estimate) -> Vec3 | None:
        if self.target == HOME:
            return seen.home
        target = seen.targets.get(self.target)
        return None if target is None else target.position
