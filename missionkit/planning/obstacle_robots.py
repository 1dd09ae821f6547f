"""Where tracked obstacle robots will be: how near one comes to a place."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from missionkit.ground_robot import GroundRobot
from missionkit.messages import Estimate, Spot, Target
from missionkit.messages.robot_modes import OBSTACLE

ROBOT = GroundRobot()
STEP = 0.5  # s, between two places that are looked at
MAYBE = 0.3  # chance to be an obstacle robot, from which one is kept clear of


def obstacle_robots(seen: Estimate) -> Iterator[Target]:
    """Yield the tracked robots that may well be obstacle robots, each once."""
    for name, it in seen.targets.items():
        if it.name == name and it.classes.get(OBSTACLE, 0.0) > MAYBE:
            yield it


def nearest_scanned(seen: Estimate) -> Spot | None:
    """Return the nearest point of a fresh scan, m, north and east; None: there is none."""
    if seen.obstacles is None or not len(seen.obstacles):
        return None
    gaps = np.hypot(*(seen.obstacles[:, :2] - seen.position[:2]).T)
    if not np.isfinite(gaps).all():
        return None
    north, east, _ = seen.obstacles[gaps.argmin()].tolist()
    return north, east


def nearest_approach(
    robots: Iterable[Target], spot: Spot, within: float
) -> tuple[float, Target | None]:
    """Return how near (m) the middle of a robot comes to a spot, and which one's; inf: no robot.

    A robot goes on along its circle. One whose heading is not known may drive straight there.

    Args:
        robots: obstacle robots.
        spot: m, north and east.
        within: s from now.
    """
    each = [(_approach(it, spot, within), it) for it in robots]
    return min(each, key=lambda it: it[0], default=(math.inf, None))


def _approach(robot: Target, spot: Spot, within: float) -> float:
    north, east = float(robot.position[0]), float(robot.position[1])
    if robot.heading is None:
        return max(0.0, math.dist((north, east), spot) - ROBOT.speed * within)
    least, heading = math.dist((north, east), spot), robot.heading
    for _ in range(math.ceil(within / STEP)):
        heading += 0.5 * ROBOT.circle_rate * STEP
        north += ROBOT.speed * STEP * math.cos(heading)
        east += ROBOT.speed * STEP * math.sin(heading)
        heading += 0.5 * ROBOT.circle_rate * STEP
        least = min(least, math.dist((north, east), spot))
    return least
