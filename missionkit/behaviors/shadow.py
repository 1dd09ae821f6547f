"""Staying above a target that moves."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import Vec3, vec
from missionkit.ground_robot import GroundRobot
from missionkit.messages import TRACKED, Estimate, Goal, Guidance, Step, Target
from missionkit.messages.robot_modes import spins
from missionkit.plugin import Behavior
from missionkit.units import Metres, MetresPerSecond

ROBOT = GroundRobot()


class Above(NamedTuple):
    """Memory of `shadow`."""

    yaw: float  # rad, where the nose points


class Shadow(Behavior):
    """Stay `height` above a tracked target and hold it in the middle of a camera that looks down.

    The vehicle flies to where the target is and leads by its velocity: by its heading while it
    drives straight, not at all while it is likelier to spin, for then it stays where it is and its
    heading turns. The guard `target_mode` reads the same probability. `lead` is `switched` by it;
    `always` leads by the heading and `never` by nothing, to compare. Done `within` of the place
    above the target, where it goes on. Without a target it holds where it is.

    Source: P4, section V, Fig. 5.
    """

    kind: ClassVar[str] = "shadow"
    target: str = Field(default=TRACKED, description="to stay above")
    height: Metres = Field(default=2.5, gt=0, description="above the ground")
    speed: MetresPerSecond = Field(default=2.13, gt=0)
    lead: Literal["switched", "always", "never"] = Field(
        default="switched", description="by the target's heading"
    )
    within: Metres = Field(default=0.3, gt=0)

    @override
    def begin(self, seen: Estimate) -> Above:
        return Above(seen.yaw)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: Above = memory or self.begin(seen)  # None: begin failed
        target = seen.targets.get(self.target)
        if target is None:
            return Step(note=f"{self.target} is not tracked", memory=on)
        north, east, ground = target.position.tolist()
        above = vec(north, east, ground - self.height)
        gap = math.dist(above[:2], seen.position[:2])
        guidance = Guidance(above, self.speed, self._lead(target), yaw=on.yaw)
        goal = Goal(above, None, seen.now, self.target)
        note = f"{gap:.2f} m off {target.name}"
        return Step(guidance, done=gap <= self.within, goal=goal, note=note, memory=on)

    def _lead(self, target: Target) -> Vec3:
        still = self.lead == "never" or (self.lead == "switched" and spins(target))
        if target.heading is None or still:
            return vec(0.0, 0.0, 0.0)
        north, east = math.cos(target.heading), math.sin(target.heading)
        return vec(ROBOT.speed * north, ROBOT.speed * east, 0.0)

    @override
    def targets(self) -> tuple[str, ...]:
        return (self.target,)
