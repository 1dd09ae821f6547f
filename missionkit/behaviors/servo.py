"""Visual servoing."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import norm, rotate, vec
from missionkit.goal_pose import bound_of, goal_of
from missionkit.messages import Estimate, Goal, Guidance, Step, Target
from missionkit.plugin import Behavior
from missionkit.units import Degrees, Metres, MetresPerSecond, Point, Seconds


class Servo(Behavior):
    """Approach the pose `standoff` = [out, right, up] (m) off a marker, facing it.

    T_goal = T_marker · T_offset  (P1, section 2.3)

    The vehicle looks at the marker on the way, so that it stays in view, and turns to the
    goal's own heading, turned by `turn_deg` from facing the marker, within `align` of it.
    Without a sighting for `patience` it stops and waits; nearer to the marker's plane than the
    goal it backs off to that first. The plane through the goal, parallel to the marker, is
    never crossed: it is approached as fast as the vehicle can brake before it.
    """

    kind: ClassVar[str] = "servo"
    target: str
    standoff: Point = (1.2, 0.0, 0.0)
    turn_deg: Degrees = Field(
        default=0.0, description="of the nose from facing the marker, clockwise"
    )
    speed: MetresPerSecond = Field(default=1.0, gt=0)
    align: Metres = Field(default=0.6, gt=0)
    patience: Seconds = 0.7

    @property
    @override
    def endless(self) -> bool:
        return True

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        target = seen.targets.get(self.target)
        goal = None if target is None else goal_of(target, self.standoff, seen.now, self.turn_deg)
        if target is None or goal is None:
            return Step(note=f"{self.target} was never seen")
        bound = bound_of(target, self.standoff[0])
        if target.seen_at is None or seen.now - target.seen_at > self.patience:
            if not _inside(seen, target, goal):
                return Step(note=f"waiting for {self.target}", goal=goal, bound=bound)
            note = f"backing off: {self.target} is out of sight"
            return Step(self._towards(seen, target, goal), goal=goal, note=note, bound=bound)
        return Step(self._towards(seen, target, goal), goal=goal, bound=bound)

    def _towards(self, seen: Estimate, target: Target, goal: Goal) -> Guidance:
        yaw = heading(seen, target, goal, self.align)
        return Guidance(goal.position, self.speed, yaw=yaw, avoid=False, work=target.position)

    @override
    def targets(self) -> tuple[str, ...]:
        return (self.target,)


def _inside(seen: Estimate, target: Target, goal: Goal) -> bool:
    """Say whether the vehicle is nearer to the marker's plane than its goal is."""
    if target.attitude is None:
        return False
    out = rotate(target.attitude, vec(0.0, 0.0, 1.0))
    return bool((goal.position - seen.position) @ out > 0.0)


def heading(seen: Estimate, target: Target, goal: Goal, align: float) -> float | None:
    """Return the heading (rad): at the target from afar, the goal's own within `align` (m).

    Args:
        seen: position of the vehicle.
        target: what to face.
        goal: with its own heading, if any.
        align: m from the goal.
    """
    if norm(goal.position - seen.position) <= align:
        return goal.yaw
    offset = target.position - seen.position
    return math.atan2(offset[1], offset[0])
