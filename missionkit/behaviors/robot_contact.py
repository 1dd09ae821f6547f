"""Meeting a ground robot: landing in front of it, and touching its top."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from pydantic import Field
from typing_extensions import override

from missionkit.behaviors.robot_meeting import (
    NEAR,
    ROBOT,
    UP,
    Meeting,
    MeetRobot,
    height_over,
    moving,
)
from missionkit.geometry import Mat
from missionkit.messages import Estimate, Step, Target
from missionkit.messages.robot_modes import spins
from missionkit.planning.obstacle_robots import nearest_approach, obstacle_robots
from missionkit.planning.target_robots import place_ahead, stands_for, way_out
from missionkit.units import Metres, Seconds

BUMP = 0.5 * ROBOT.diameter + 0.2  # m, of centres; the vehicle of the paper
LATE = 0.4  # s, that a bump may be late


class LandInFront(MeetRobot):
    """Land in front of a tracked robot so that its bumper hits the vehicle and it turns by 180 deg.

    A plan by differential dynamic programming leads the robot by its speed times the time until
    touch-down, and by `block`, the distance of the centres then: the robot has 0.17 m to its
    bumper, so that under 0.37 m it would be a touch on top of a vehicle of 0.2 m. First it flies
    ahead of the robot at `height`, then down to `lowest`, where it waits; done once the robot
    spins, or when it must have come, after `wait` at most: from down there the camera loses it.

    It never lands before a robot that may be an obstacle robot, nor while the heading is not known,
    nor where an obstacle robot would come within `keep_out` before it is up again; then it holds
    and says so. After `patience`, and at once when it has begun to descend, it gives up: it is
    done, with the event `meeting.given_up`, wherever it is then; so it does if the robot begins to
    spin before the vehicle is lower than 0.5 m. A robot that spins when the meeting begins is met
    where it drives after it. The way keeps clear of obstacle robots, which carry towers up to 2 m,
    as if they had any height.

    Source: P4, sections IV and V; the goal is (35) with all six components.
    """

    kind: ClassVar[str] = "land_in_front"
    block: Metres = Field(default=0.5, gt=0, description="distance of centres at touch-down")
    lowest: Metres = Field(default=0.05, ge=0, description="above the ground, down")
    wait: Seconds = Field(default=1.5, description="most, down, for the bump")

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: Meeting = memory or self.begin(seen)  # None: begin failed
        if on.down_since is None:
            return super().step(seen, on)
        target = seen.targets.get(on.robot or "")
        turned = target is not None and spins(target)
        here = float(seen.position[0]), float(seen.position[1])
        away = nearest_approach(obstacle_robots(seen), here, self._stays + UP)[0]
        over = seen.now >= on.leaves_at or away < self.keep_out
        return self._down(seen, on, done=turned or over)

    @property
    @override
    def _lowest(self) -> float:
        return self.lowest

    @property
    @override
    def _stays(self) -> float:
        return min(self.wait, (self.block - BUMP) / ROBOT.speed + LATE)

    @property
    @override
    def _ahead(self) -> float:
        return self.block

    @override
    def _reference(self, target: Target, on: Meeting, contact_in: float) -> Mat:
        if not on.low:
            return moving(target, self.block, self.height)
        spot = np.zeros(6)
        spot[:2] = place_ahead(target, self.block, contact_in)
        spot[2] = target.position[2] - self.lowest
        return spot

    @override
    def _met(self, seen: Estimate, target: Target, on: Meeting) -> tuple[Meeting, bool]:
        if on.low and height_over(seen, target) <= self.lowest + NEAR:
            comes_in = stands_for(target) + (self._gap(seen, target) - BUMP) / ROBOT.speed
            leaves_at = seen.now + min(max(0.0, comes_in) + LATE, self.wait)
            on = on._replace(down_since=seen.now, leaves_at=leaves_at)
        return on, False

    def _gap(self, seen: Estimate, target: Target) -> float:
        """Return how far (m) the vehicle is ahead of the robot."""
        return float((seen.position[:2] - target.position[:2]) @ way_out(target))


class TouchTop(MeetRobot):
    """Touch the plate on top of a tracked robot, so that it turns by 45 deg clockwise.

    A plan by differential dynamic programming follows the robot, first at `height` and then down
    onto its plate, `plate` above the ground; done when the vehicle is there. It refuses as
    `land_in_front` does, and waits while the robot spins, for it would not notice.

    Source: P4, section IV; the organisers' firmware.
    """

    kind: ClassVar[str] = "touch_top"
    plate: Metres = Field(default=ROBOT.height, gt=0, description="above the ground")

    @property
    @override
    def _lowest(self) -> float:
        return self.plate - 0.02

    @property
    @override
    def _ahead(self) -> float:
        return 0.0

    @property
    @override
    def _drives_before(self) -> float:
        return 0.3

    @override
    def _reference(self, target: Target, on: Meeting, contact_in: float) -> Mat:
        return moving(target, 0.0, self._lowest if on.low else self.height)

    @override
    def _met(self, seen: Estimate, target: Target, on: Meeting) -> tuple[Meeting, bool]:
        return on, on.low and height_over(seen, target) <= self.plate + 0.01
