"""Second stage of docking: on towards the target, turned as it will dock."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.behaviors.docking.docking_pose import DockingBehavior
from missionkit.messages import Estimate, Guidance, Step
from missionkit.units import Degrees, Metres


class Reorient(DockingBehavior):
    """Turn to the attitude of a docked vehicle while flying on towards the target.

    Done when it is turned so to within `within_deg`. It stops at `stop` or at `keep_out`, whichever
    is farther out.

    Source: P3 section V, second guidance mode.
    """

    kind: ClassVar[str] = "reorient"
    stop: Metres = Field(default=0.1, ge=0, description="from the target's centre")
    within_deg: Degrees = Field(default=5.0, gt=0)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        pose = self.pose(seen)
        if pose is None:
            return self.lost(memory)
        place = pose.towards(seen.position, max(self.stop, self.keep_out))
        if place is None:
            return self.lost(memory)
        return Step(
            Guidance(place, self.speed, attitude=pose.attitude),
            done=math.degrees(pose.misalignment(seen.attitude)) <= self.within_deg,
            goal=self.goal(place, seen),
            payload=self.camera,
            memory=memory,
        )
