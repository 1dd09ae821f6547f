"""When the way along an obstacle's boundary begins and ends, and the velocity along it.

It begins after `patience` without progress near an obstacle, on the shorter side. It ends nearer
to the goal than it began, and with a free path ahead.

Source: V. Lumelsky, A. Stepanov, "Path-planning strategies for a point mobile automaton", 1987.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from missionkit.geometry import Vec3
from missionkit.messages import Estimate
from missionkit.planning.boundary_following import BoundaryProgress, follow, shorter_side
from missionkit.planning.obstacle_braking import (
    NearbyObstacles,
    Stopping,
    braked,
    free_path,
    stopping_distance,
)


class EscapeLimits(NamedTuple):
    """How an obstacle is left behind."""

    step_size: float  # m nearer to the goal that count as progress
    patience: float  # s without progress before an escape begins
    longest: float  # s after which any free way to the goal ends it
    keep: float  # m, distance to the boundary
    speed: float  # m/s, along the boundary
    stopping: Stopping


def progressed(
    last: BoundaryProgress,
    seen: Estimate,
    goal: Vec3,
    around: NearbyObstacles,
    how: EscapeLimits,
    *,
    hindered: bool,
) -> BoundaryProgress:
    """Return how the way to the goal is going now.

    Args:
        last: what this returned a step ago.
        seen: the estimate at this tick.
        goal: (3,), m, NED.
        around: obstacles near the vehicle.
        how: when to begin and to end an escape.
        hindered: whether the obstacles change the wanted velocity much.
    """
    to_goal = goal - seen.position
    distance = math.hypot(*to_goal.tolist())
    if last.since == math.inf:
        last = last._replace(since=seen.now)
    if last.side:
        farther = distance > last.best - how.step_size
        patient = seen.now - last.since < how.longest
        away = (farther and patient) or _blocked(around, to_goal, distance, how)
        return last if away else BoundaryProgress(distance, seen.now)
    if distance < last.best - how.step_size:
        return BoundaryProgress(distance, seen.now)
    if not hindered or distance < how.step_size:
        return last._replace(since=seen.now)
    if seen.now - last.since < how.patience:
        return last
    passage = 2.0 * how.stopping.width
    return last._replace(side=shorter_side(around.away, to_goal, seen.velocity, passage))


def past(
    around: NearbyObstacles,
    seen: Estimate,
    side: int,
    climb: float,
    body: float,
    how: EscapeLimits,
) -> Vec3:
    """Return the velocity (3,), m/s, NED, along the boundary, braked before other obstacles.

    Args:
        around: obstacles near the vehicle.
        seen: the estimate at this tick.
        side: as `follow` takes it.
        climb: m/s, down, that is kept.
        body: m, radius of the vehicle.
        how: the distance to keep, the speed, the stopping.
    """
    i = int(around.squared.argmin())
    gap = math.sqrt(around.squared[i]) - body
    along = follow(around.away[i], gap, how.keep, how.speed, side)
    along[2] = climb
    return braked(along, seen.velocity, around, how.stopping)


def _blocked(around: NearbyObstacles, to_goal: Vec3, distance: float, how: EscapeLimits) -> bool:
    free = free_path(around, to_goal / distance, how.stopping)
    return free < min(distance, stopping_distance(how.speed, how.stopping))
