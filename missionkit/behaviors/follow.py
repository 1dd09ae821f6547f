"""Following a target that moves."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.behaviors.route_flight import bearing
from missionkit.geometry import Vec3, vec, wrap
from missionkit.messages import TRACKED, Estimate, Goal, Guidance, Step, Target
from missionkit.plugin import Behavior
from missionkit.units import Degrees, Metres, MetresPerSecond, Seconds

MOVING = 0.3  # m/s, from which on a target's velocity gives its course
SWING = 0.5  # rad/s, at most, of the place behind a target that turns


class Following(NamedTuple):
    """Memory of `follow`."""

    bearing: float  # rad, from the target to the place beside it
    at: float  # s


class Follow(Behavior):
    """Keep `distance` from a moving target, looking at it; done within `within` of that place.

    `side` says where that is: `here`, on the side from which the vehicle came, whichever way the
    target turns; `behind` or `ahead` of it, by its velocity; or `bearing`, at `bearing_deg` from it
    (0: north of it). The place swings round a target that turns by 0.5 rad/s at most. `height` is
    above the take-off point; without it the vehicle keeps the height it came with. The target's
    velocity is fed forward, where it is known. Not seen for `patience`, or not tracked any longer,
    it is waited for. It goes on when it is done.
    """

    kind: ClassVar[str] = "follow"
    target: str = Field(default=TRACKED, description="to follow")
    distance: Metres = Field(default=6.0, gt=0, description="level, from the target")
    side: Literal["here", "behind", "ahead", "bearing"] = Field(
        default="here", description="of the target, on which the vehicle stays"
    )
    bearing_deg: Degrees = Field(default=0.0, description="from the target, for side: bearing")
    height: Metres | None = Field(default=None, description="above the take-off point")
    speed: MetresPerSecond = Field(default=6.0, gt=0)
    within: Metres = Field(default=1.0, gt=0)
    patience: Seconds = Field(default=2.0, description="without a sighting, until it waits")

    @override
    def begin(self, seen: Estimate) -> tuple[Following | None, float]:
        return None, float(seen.position[2])

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on, down = memory
        target = seen.targets.get(self.target)
        if target is None:
            return Step(note=f"{self.target} is not known", memory=memory)
        if target.seen_at is not None and seen.now - target.seen_at > self.patience:
            return Step(note=f"waiting for {self.target}: it is out of sight", memory=memory)
        on = self._swung(seen, target, on)
        velocity = vec(0.0, 0.0, 0.0) if target.velocity is None else target.velocity.copy()
        velocity[2] = 0.0
        place = self._place(target, on, down)
        goal = Goal(place, None, seen.now, self.target)
        return Step(
            Guidance(place, self.speed, velocity, bearing(seen.position, target.position)),
            done=math.dist(place, seen.position) <= self.within,
            goal=goal,
            note=f"{math.dist(seen.position[:2], target.position[:2]):.1f} m from {self.target}",
            memory=(on, down),
        )

    @override
    def targets(self) -> tuple[str, ...]:
        return (self.target,)

    def _place(self, target: Target, on: Following, down: float) -> Vec3:
        if self.height is not None:
            down = -self.height
        north, east, _ = target.position.tolist()
        north += self.distance * math.cos(on.bearing)
        east += self.distance * math.sin(on.bearing)
        return vec(north, east, down)

    def _swung(self, seen: Estimate, target: Target, on: Following | None) -> Following:
        """Return the bearing to keep, turned at most as fast as the place may swing."""
        wanted = self._wanted(target)
        if on is None:
            here = bearing(target.position, seen.position)
            first = wanted if wanted is not None else here
            return Following(seen.yaw + math.pi if first is None else first, seen.now)
        if wanted is None:
            return on._replace(at=seen.now)
        most = SWING * max(0.0, seen.now - on.at)
        off = wrap(wanted - on.bearing)
        return Following(on.bearing + min(most, max(-most, off)), seen.now)

    def _wanted(self, target: Target) -> float | None:
        """Return the bearing (rad) that `side` asks for, None to keep the present one."""
        if self.side == "bearing":
            return math.radians(self.bearing_deg)
        moves = target.velocity
        if self.side == "here" or moves is None or math.hypot(moves[0], moves[1]) < MOVING:
            return None
        course = math.atan2(moves[1], moves[0])
        return course if self.side == "ahead" else course + math.pi
