"""Distances."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import norm
from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.plugin import Guard
from missionkit.units import Metres

GOAL_DISTANCE = Quantity("distance to the goal", unit="m", at_entry="unknown")


class Within(Guard):
    """Holds within `radius` of a target.

    C_range: ||p_target - p|| ≤ r_visual  (P1, section 1.2)
    """

    kind: ClassVar[str] = "within"
    of: str
    radius: Metres = Field(gt=0)

    @override
    def check(self, seen: Estimate) -> Verdict:
        target = seen.targets.get(self.of)
        if target is None:
            return Verdict.unknown(f"the position of {self.of} is unknown")
        return Verdict.at_most(norm(target.position - seen.position), self.radius)

    @override
    def region(self) -> Region:
        return Region.of(distance_to(self.of), Interval.at_most(self.radius))


class NearGoal(Guard):
    """Holds within `radius` of the active behaviour's goal.

    C_proximity: ||p_goal - p|| ≤ r_gps_tolerance  (P1, section 1.2)
    """

    kind: ClassVar[str] = "near_goal"
    radius: Metres = Field(gt=0)

    @override
    def check(self, seen: Estimate) -> Verdict:
        if seen.goal is None:
            return Verdict.unknown("the behaviour has no goal yet")
        return Verdict.at_most(norm(seen.goal.position - seen.position), self.radius)

    @override
    def region(self) -> Region:
        return Region.of(GOAL_DISTANCE, Interval.at_most(self.radius))


def distance_to(target: str) -> Quantity:
    """Return the distance to a target."""
    return Quantity(f"distance to {target}", unit="m")
