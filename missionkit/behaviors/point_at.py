"""Turning the nose."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.behaviors.go_to import HOME
from missionkit.behaviors.route_flight import bearing
from missionkit.geometry import Vec3, norm, wrap
from missionkit.messages import Estimate, Goal, Guidance, Step
from missionkit.plugin import Behavior
from missionkit.units import Degrees

ASIDE = 2.0  # m, from the place, at which it is not done
SLOW = 0.1  # rad/s, that counts as having turned


class PointAt(Behavior):
    """Stay where the state was entered and turn the nose to `target`; done `within_deg` of it.

    It goes on turning after a target that moves, and after the vehicle's own drift. A target that
    is straight below or above has no heading: the nose then stays.
    """

    kind: ClassVar[str] = "point_at"
    target: str
    within_deg: Degrees = Field(default=3.0, gt=0)

    @override
    def begin(self, seen: Estimate) -> Vec3:
        return seen.position

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        place = seen.home if self.target == HOME else None
        if self.target in seen.targets:
            place = seen.targets[self.target].position
        if place is None:
            return Step(note=f"the position of {self.target} is unknown", memory=memory)
        yaw = bearing(seen.position, place)
        off = 0.0 if yaw is None else abs(wrap(yaw - seen.yaw))
        there = math.dist(seen.position, memory) <= ASIDE and norm(seen.rates) < SLOW
        done = there and off <= math.radians(self.within_deg)
        guidance = Guidance(memory, 1.0, yaw=seen.yaw if yaw is None else yaw)
        goal = Goal(memory, yaw, seen.now, self.target)
        note = f"{math.degrees(off):.0f} deg off"
        return Step(guidance, done=done, goal=goal, note=note, memory=memory)

    @override
    def targets(self) -> tuple[str, ...]:
        return () if self.target == HOME else (self.target,)
