"""Climbing from near the ground, away from obstacle robots."""

from __future__ import annotations

import math
from typing import Any, ClassVar, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import vec
from missionkit.messages import TRACKED, Estimate, Goal, Guidance, Spot, Step
from missionkit.planning.obstacle_robots import (
    nearest_approach,
    nearest_scanned,
    obstacle_robots,
)
from missionkit.plugin import Behavior
from missionkit.units import Metres, MetresPerSecond

SOON = 1.5  # s; an obstacle robot is kept away from for so long ahead
DONE = 0.3  # m below the height


class Climbing(NamedTuple):
    """Memory of `climb_clear`."""

    north: float  # m, where it began
    east: float  # m
    yaw: float  # rad


class ClimbClear(Behavior):
    """Climb straight up to `height`, from the ground too, for sideways it might be hit.

    From a tracked obstacle robot that comes nearer than `keep_out`, and from what a range sensor
    sees so near, it moves away as it climbs.
    """

    kind: ClassVar[str] = "climb_clear"
    height: Metres = Field(default=3.0, gt=0, description="above the ground")
    speed: MetresPerSecond = Field(default=2.13, gt=0)
    keep_out: Metres = Field(default=1.0, gt=0, description="from obstacle robots' centres")

    @override
    def begin(self, seen: Estimate) -> Climbing:
        return Climbing(float(seen.position[0]), float(seen.position[1]), seen.yaw)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: Climbing = memory or self.begin(seen)  # None: begin failed
        here = float(seen.position[0]), float(seen.position[1])
        away, robot = nearest_approach(obstacle_robots(seen), here, SOON)
        note, scanned = "climbing", nearest_scanned(seen)
        if scanned is not None and math.dist(scanned, here) < self.keep_out:
            on = self._moved(here, scanned, on)
            note = f"climbing away from what stands {math.dist(scanned, here):.1f} m off"
        elif robot is not None and away < self.keep_out:
            on = self._moved(here, (float(robot.position[0]), float(robot.position[1])), on)
            note = f"climbing away from {robot.name}, which comes within {away:.1f} m"
        place = vec(on.north, on.east, -self.height)
        guidance = Guidance(place, self.speed, yaw=on.yaw, avoid=False)
        goal = Goal(place, None, seen.now, TRACKED)
        done = -float(seen.position[2]) >= self.height - DONE
        return Step(guidance, done=done, goal=goal, note=note, memory=on, lands=True)

    def _moved(self, here: Spot, other: Spot, on: Climbing) -> Climbing:
        """Return the memory with a place away from another."""
        north, east = here[0] - other[0], here[1] - other[1]
        gap = max(math.hypot(north, east), 1e-6)
        share = max(0.0, self.keep_out - gap) / gap
        return on._replace(north=here[0] + share * north, east=here[1] + share * east)
