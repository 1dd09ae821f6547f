"""Flight to a point."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import Vec3, norm, vec
from missionkit.goal_pose import goal_of
from missionkit.messages import Estimate, Goal, Guidance, Step
from missionkit.plugin import Behavior
from missionkit.units import Degrees, Metres, MetresPerSecond, Point

HOME = "home"
RECEDING = 0.7  # m/s away from the goal, level: it comes to rest before it turns round


class GoTo(Behavior):
    """Fly to `target` at up to `speed`, obstacles permitting; done `within` of it, nearly at rest.

    `target` is a target of the mission or `home`, the place of arming. `standoff` stays off a
    marker by [out of the marker, right, up] (m), as the viewer sees it; from this far only its
    heading is used, since a small error of its tilt would be metres of height. `height` above the
    take-off point overrides the goal's own; the way home keeps the height it began with. A vehicle
    that begins by flying away from its goal, as at a fence, comes to rest before it turns round.
    """

    kind: ClassVar[str] = "go_to"
    target: str
    standoff: Point = (0.0, 0.0, 0.0)
    turn_deg: Degrees = Field(
        default=0.0, description="of the nose from facing the marker, clockwise"
    )
    height: Metres | None = None
    speed: MetresPerSecond = Field(default=5.0, gt=0)
    within: Metres = Field(default=1.0, gt=0)

    @override
    def begin(self, seen: Estimate) -> Any:
        return float(seen.position[2]), True

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        down, turning = memory or self.begin(seen)  # None: begin failed
        goal = self._goal(seen, down)
        if goal is None:
            return Step(note=f"the position of {self.target} is unknown", memory=memory)
        if turning and _receding(seen, goal):
            note = "stopping before turning back"
            return Step(stop=True, note=note, goal=goal, memory=memory)
        near = norm(goal.position - seen.position) <= self.within
        done = near and norm(seen.velocity) < 0.5
        guidance = Guidance(goal.position, self.speed, final_yaw=goal.yaw)
        return Step(guidance, done=done, goal=goal, memory=(down, False))

    @override
    def targets(self) -> tuple[str, ...]:
        return () if self.target == HOME else (self.target,)

    def _goal(self, seen: Estimate, down: float) -> Goal | None:
        if self.target == HOME:
            if seen.home is None:
                return None
            return self._at_height(vec(seen.home[0], seen.home[1], down), None, seen)
        target = seen.targets.get(self.target)
        if target is None:
            return None
        pose = None
        if any(self.standoff):
            pose = goal_of(target, self.standoff, seen.now, self.turn_deg)
        if pose is None:
            return self._at_height(target.position, None, seen)
        level = vec(pose.position[0], pose.position[1], target.position[2] - self.standoff[2])
        return self._at_height(level, pose.yaw, seen)

    def _at_height(self, position: Vec3, yaw: float | None, seen: Estimate) -> Goal:
        down = position[2] if self.height is None else -self.height
        return Goal(vec(position[0], position[1], down), yaw, seen.now)


def _receding(seen: Estimate, goal: Goal) -> bool:
    """Say whether the vehicle, in the air, flies away from its goal."""
    status = seen.status
    if status is None or not status.in_air or seen.health.diverged:
        return False
    north, east, _ = (goal.position - seen.position).tolist()
    towards = seen.velocity[0] * north + seen.velocity[1] * east
    return bool(towards < -RECEDING * math.hypot(north, east))
