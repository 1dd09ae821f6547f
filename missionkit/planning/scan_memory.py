"""Memory of the potential field between steps: the last scan, and the way to the goal."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Vec3
from missionkit.messages import Points
from missionkit.planning.boundary_following import BoundaryProgress
from missionkit.planning.obstacle_braking import NearbyObstacles

NEW_GOAL = 1.0  # m, by which a goal moves before the way to it starts over


class FieldMemory(NamedTuple):
    """Memory of the potential field between steps."""

    points: Points | None = None  # (N, 3), m, NED, of the last scan
    scanned_at: float = -math.inf  # s, when it was measured
    sight: float = math.inf  # m, how far it saw
    goal: tuple[float, float, float] | None = None  # m, NED
    progress: BoundaryProgress = BoundaryProgress()

    def clear(self) -> FieldMemory:
        """Return the memory when nothing is near: no escape, no waiting for progress."""
        if self.progress.since == math.inf:
            return self
        return self._replace(progress=BoundaryProgress(self.progress.best))

    def aimed(self, goal: Vec3) -> FieldMemory:
        """Return the memory with a goal (3,), m, NED; a new one restarts the progress."""
        x, y, z = goal.tolist()
        if self.goal is None or math.dist(self.goal, (x, y, z)) > NEW_GOAL:
            return self._replace(goal=(x, y, z), progress=BoundaryProgress())
        return self


def finite(points: Points) -> Points:
    """Return the points (N, 3) without those that are not finite."""
    if math.isfinite(points.sum()):
        return points
    return points[np.isfinite(points).all(axis=1)]


def nearby(points: Points, position: Vec3, reach: float, column: float) -> NearbyObstacles | None:
    """Return the obstacles around the vehicle, None if none is within reach.

    Args:
        points: (N, 3), m, NED, N at least one.
        position: (3,), m, NED, of the vehicle.
        reach: m.
        column: m, half height for which each point counts as an upright column.
    """
    away = position - points
    squared = np.vecdot(away, away)
    if not squared[squared.argmin()] <= reach * reach:
        return None
    z = away[:, 2]
    away[:, 2] = z - np.minimum(column, np.maximum(-column, z))
    return NearbyObstacles(away, np.vecdot(away, away))
