"""Convergence on the goal pose."""

from __future__ import annotations

import math
from typing import ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import norm, wrap
from missionkit.guards.distances import GOAL_DISTANCE
from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import ONLY_FALSE, ONLY_TRUE, Interval, Quantity, Region
from missionkit.plugin import Guard
from missionkit.units import Degrees, Metres, MetresPerSecond, Seconds

SPEED_QUANTITY = Quantity("speed", unit="m/s")
ON_TARGET = Quantity("goal on a target", most=1.0, whole=True, at_entry="unknown")
GOAL_AGE = Quantity("time since the goal's target was seen", unit="s")
YAW_ERROR = Quantity("yaw error", most=180.0, unit="deg", at_entry="unknown")


class Converged(Guard):
    """Holds within `position` and `yaw_deg` of the active behaviour's goal, nearly at rest.

    ||p - p_goal|| ≤ ε_pos and |ψ - ψ_goal| ≤ ε_yaw  (P1, section 8.1: 0.1 m, 5 deg)

    A goal on a target must have been measured within `max_age`, by sightings that fit the filter's
    noise, else the answer is unknown.
    The verdict's value is the position error, or the yaw error if that is what fails.
    """

    kind: ClassVar[str] = "converged"
    position: Metres = Field(default=0.10, gt=0)
    yaw_deg: Degrees = Field(default=5.0, gt=0)
    speed: MetresPerSecond = Field(default=0.2, gt=0)
    max_age: Seconds = 1.0

    @override
    def check(self, seen: Estimate) -> Verdict:
        goal = seen.goal
        if goal is None:
            return Verdict.unknown("the behaviour has no goal yet")
        if goal.target is not None and not _fresh(seen, goal.target, self.max_age):
            return Verdict.unknown(f"{goal.target} was not seen in the last {self.max_age:g} s")
        if goal.target is not None and seen.health.misfit:
            return Verdict.unknown(seen.health.misfit)
        error = norm(seen.position - goal.position)
        if goal.yaw is not None:
            yaw_error = math.degrees(abs(wrap(goal.yaw - seen.yaw)))
            if yaw_error > self.yaw_deg and error <= self.position:
                return Verdict.at_most(yaw_error, self.yaw_deg, "yaw error, deg")
        speed = norm(seen.velocity)
        if error <= self.position and speed > self.speed:
            return Verdict.at_most(speed, self.speed, "still moving, m/s")
        return Verdict.at_most(error, self.position, "position error, m")

    @override
    def region(self) -> Region:
        near = {
            GOAL_DISTANCE: Interval.at_most(self.position),
            SPEED_QUANTITY: Interval.at_most(self.speed),
        }
        turned = {**near, YAW_ERROR: Interval.at_most(self.yaw_deg)}
        fresh = {ON_TARGET: ONLY_TRUE, GOAL_AGE: Interval.at_most(self.max_age)}
        return Region(
            ({**near, ON_TARGET: ONLY_FALSE}, {**near, **fresh}),
            ({**turned, ON_TARGET: ONLY_FALSE}, {**turned, **fresh}),
        )


def _fresh(seen: Estimate, name: str, max_age: float) -> bool:
    target = seen.targets.get(name)
    if target is None or target.seen_at is None:
        return False
    return seen.now - target.seen_at <= max_age
