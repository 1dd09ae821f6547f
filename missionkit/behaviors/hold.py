"""Hover."""

from __future__ import annotations

from typing import Any, ClassVar

from typing_extensions import override

from missionkit.geometry import Vec3
from missionkit.messages import Estimate, Guidance, Step
from missionkit.plugin import Behavior


class Hold(Behavior):
    """Stay where the state was entered; on the ground, do nothing."""

    kind: ClassVar[str] = "hold"

    @property
    @override
    def endless(self) -> bool:
        return True

    @override
    def begin(self, seen: Estimate) -> Vec3:
        return seen.position

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        if seen.status is None or not seen.status.in_air:
            return Step(memory=memory)
        return Step(Guidance(memory, speed=1.0, yaw=None), memory=memory)
