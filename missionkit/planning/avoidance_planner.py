"""Base class of planners for `avoid:`: memory in, memory out, like guards and behaviours."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

from missionkit.geometry import Vec3
from missionkit.messages import Estimate


@runtime_checkable
class AvoidancePlanner(Protocol):
    """Says what to add to a wanted velocity. Its memory is an immutable value."""

    def begin(self) -> Any:
        """Return the memory at the start."""

    def step(self, memory: Any, seen: Estimate, goal: Vec3, wanted: Vec3) -> tuple[Vec3, Any]:
        """Return what to add to the wanted velocity, and the next memory.

        Args:
            memory: what this returned a step ago.
            seen: the estimate at this tick.
            goal: (3,), m, NED.
            wanted: (3,), m/s, NED, velocity that would be flown if nothing were near.

        Returns:
            (3,), m/s, NED, finite.
        """
