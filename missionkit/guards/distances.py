"""Distances."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import norm
from missionkit.guards.comparison import ComparedGuard, Comparison
from missionkit.messages import Estimate
from missionkit.messages.region import Quantity
from missionkit.units import Metres

GOAL_DISTANCE = Quantity("distance to the goal", unit="m", at_entry="unknown")


class Within(ComparedGuard):
    """Holds within `radius` of a target.

    C_range: ||p_target - p|| ≤ r_visual  (P1, section 1.2)
    """

    kind: ClassVar[str] = "within"
    of: str
    radius: Metres = Field(gt=0)

    @override
    def measured(self, seen: Estimate) -> float | str:
        target = seen.targets.get(self.of)
        if target is None:
            return f"the position of {self.of} is unknown"
        return norm(target.position - seen.position)

    @override
    def comparison(self) -> Comparison:
        return Comparison(distance_to(self.of), "at_most", self.radius)


class NearGoal(ComparedGuard):
    """Holds within `radius` of the active behaviour's goal.

    C_proximity: ||p_goal - p|| ≤ r_gps_tolerance  (P1, section 1.2)
    """

    kind: ClassVar[str] = "near_goal"
    radius: Metres = Field(gt=0)

    @override
    def measured(self, seen: Estimate) -> float | str:
        if seen.goal is None:
            return "the behaviour has no goal yet"
        return norm(seen.goal.position - seen.position)

    @override
    def comparison(self) -> Comparison:
        return Comparison(GOAL_DISTANCE, "at_most", self.radius)


def distance_to(target: str) -> Quantity:
    """Return the distance to a target."""
    return Quantity(f"distance to {target}", unit="m")
