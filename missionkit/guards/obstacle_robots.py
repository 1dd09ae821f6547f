"""Obstacle robots near a vehicle that flies low."""

from __future__ import annotations

import math
from typing import ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.planning.obstacle_robots import (
    nearest_approach,
    nearest_scanned,
    obstacle_robots,
)
from missionkit.plugin import Guard
from missionkit.units import Metres, Seconds


class ObstacleRobotNear(Guard):
    """Holds while the vehicle is lower than `below` and an obstacle robot comes within `within`.

    Middles are `within` of each other, horizontally, at some time in the next `ahead` seconds, if
    the robot goes on along its circle and the vehicle stays where it is. A tracked robot that is an
    obstacle robot with a chance of 0.3 counts. Where the camera has not looked a range sensor may
    see its tower: anything that it sees within `scanned` counts too. Unknown while there is
    neither, or above `below`.
    """

    kind: ClassVar[str] = "obstacle_robot_near"
    within: Metres = Field(default=0.8, gt=0)
    ahead: Seconds = Field(default=2.0, ge=0, description="of time")
    scanned: Metres = Field(default=1.2, gt=0, description="from what a range sensor sees")
    below: Metres = Field(default=2.3, gt=0, description="above the ground: no tower is so high")

    @override
    def check(self, seen: Estimate) -> Verdict:
        here = float(seen.position[0]), float(seen.position[1])
        height = -float(seen.position[2])
        if height >= self.below:
            return Verdict.unknown(f"{height:.1f} m is above all towers")
        scanned = nearest_scanned(seen)
        if scanned is not None and math.dist(scanned, here) <= self.scanned:
            return Verdict.at_most(math.dist(scanned, here), self.scanned, "the range sensor")
        away, robot = nearest_approach(obstacle_robots(seen), here, self.ahead)
        if robot is None:
            return Verdict.unknown("no obstacle robot is tracked")
        return Verdict.at_most(away, self.within, robot.name)

    @override
    def region(self) -> Region:
        distance = Quantity(f"least distance to obstacle robots below {self.below:g} m", unit="m")
        return Region.of(distance, Interval.at_most(self.within))
