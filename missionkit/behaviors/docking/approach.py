"""First stage of docking: straight towards the target."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.behaviors.docking.docking_pose import DockingBehavior
from missionkit.geometry import norm
from missionkit.messages import Estimate, Guidance, Step
from missionkit.units import Metres


class Approach(DockingBehavior):
    """Fly straight towards the target and keep the attitude it began with; done at `stop`.

    The line of sight is that at each moment, so that an estimate that improves corrects it. It
    never leads nearer than `keep_out` to the target's centre.

    Source: P3 section V, first guidance mode.
    """

    kind: ClassVar[str] = "approach"
    stop: Metres = Field(default=0.3, gt=0, description="from the target's centre")

    @override
    def begin(self, seen: Estimate) -> Any:
        return seen.attitude

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        pose = self.pose(seen)
        if pose is None:
            return self.lost(memory)
        place = pose.towards(seen.position, max(self.stop, self.keep_out))
        if place is None:
            return self.lost(memory)
        attitude = seen.attitude if memory is None else memory
        return Step(
            Guidance(place, self.speed, attitude=attitude),
            done=norm(seen.position - pose.centre) <= max(self.stop, self.keep_out),
            goal=self.goal(place, seen),
            payload=self.camera,
            memory=memory,
        )
