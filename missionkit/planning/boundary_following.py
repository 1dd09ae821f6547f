"""Out of the local minima of a potential field: follow the obstacle's boundary for a while.

The field is left when there is no progress, and joined again only nearer to the goal than it
was left and with a free path ahead: each stay in the field then ends nearer than the one before.

Source: V. Lumelsky, A. Stepanov, "Path-planning strategies for a point mobile automaton", 1987.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Vec3
from missionkit.messages import Points

NEIGHBOURS = math.radians(8.0)  # adjacent rays of a 5 degree scan belong to one surface


class BoundaryProgress(NamedTuple):
    """How the way to the goal is going."""

    best: float = math.inf  # m, least distance to the goal
    since: float = math.inf  # s, when that was last bettered by a step; inf: nothing is near
    side: int = 0  # +1: round the obstacle clockwise seen from above, -1: the other way, 0: no


def follow(nearest: Vec3, gap: float, keep: float, speed: float, side: int) -> Vec3:
    """Return the velocity (3,), m/s, level, that follows a boundary.

    The tangential field turned from the repulsion, with what keeps the distance.

    Args:
        nearest: (3,), m, from the nearest point to the vehicle.
        gap: distance from the vehicle's surface to that point (m).
        keep: distance to keep (m).
        speed: along the boundary (m/s).
        side: +1 turns the repulsion clockwise seen from above (obstacle on the right).
    """
    x, y = float(nearest[0]), float(nearest[1])
    size = math.hypot(x, y)
    if size == 0.0:
        return np.zeros(3)
    x, y = x / size, y / size
    out = min(speed, max(-speed, 1.5 * (keep - gap)))
    velocity = (out * x - side * speed * y, out * y + side * speed * x)
    k = speed / math.hypot(*velocity)
    return np.array([k * velocity[0], k * velocity[1], 0.0])


def shorter_side(away: Points, goal: Vec3, velocity: Vec3, passage: float) -> int:
    """Return the side for `follow` on which the way round to the goal is shorter.

    From the direction of the goal, neighbouring points are followed to either side up to the
    first gap that is wide enough; the way leads by the last point. Equal ways are decided by
    where the vehicle already moves, then to the right.

    Args:
        away: (N, 3), m, NED, from each point to the vehicle.
        goal: (3,), m, NED, from the vehicle to the goal.
        velocity: (3,), m/s, NED, of the vehicle.
        passage: width through which the vehicle fits (m).
    """
    ahead = math.atan2(goal[1], goal[0])
    bearing = np.arctan2(-away[:, 1], -away[:, 0]) - ahead
    bearing = (bearing + math.pi) % math.tau - math.pi  # (N,), clockwise from the goal
    right = _way_round(-away, bearing, goal, passage)
    left = _way_round(-away, -bearing, goal, passage)
    if abs(right - left) > 0.5:
        return -1 if right < left else 1
    drift = velocity[1] * goal[0] - velocity[0] * goal[1]
    return 1 if drift < 0.0 else -1


def _way_round(points: Points, bearing: Points, goal: Vec3, passage: float) -> float:
    """Return the length (m) to the goal by the last point of the surface at rising bearings."""
    order = np.argsort(bearing)
    order = order[bearing[order] >= -NEIGHBOURS]
    last = None
    angle = 0.0
    for i in order:
        if last is None:
            joined = bearing[i] <= NEIGHBOURS
        else:
            apart = math.dist(points[i, :2], points[last, :2])
            joined = bearing[i] - angle <= NEIGHBOURS or apart < passage
        if not joined:
            break
        last, angle = i, float(bearing[i])
    if last is None:
        return math.hypot(goal[0], goal[1])
    edge = points[last, :2]
    return math.hypot(*edge) + math.dist(edge, goal[:2])
