"""Whether a path that was free still is.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from missionkit.geometry import Mat
from missionkit.jit import compiled
from missionkit.messages import Occupancy, Points, Spot
from missionkit.messages.occupancy import Costs
from missionkit.planning.path_smoothing import line_cost

NEARER = 0.05  # m, more than the noise of a scan


def walled(known: Occupancy, pieces: Iterable[tuple[Spot, Spot]]) -> bool:
    """Say whether a piece of a path leads through a wall of the map or off it."""
    lines = [(*known.cell(start), *known.cell(end)) for start, end in pieces]
    return bool(lines) and _walled(known.costs, np.array(lines))


def in_the_way(points: Points, pieces: Iterable[tuple[Spot, Spot]], gap: float, here: Spot) -> bool:
    """Say whether a path comes too near to something sensed.

    A vehicle that is nearer than `gap` to something already may follow a path that comes as near
    to anything, and no nearer: how the planner leads out of a margin (`route_planning.plan`).

    Args:
        points: (N, 3), m, NED, sensed.
        pieces: of the path ahead.
        gap: to be kept (m).
        here: the vehicle.
    """
    lines = [(*start, *end) for start, end in pieces]
    if not lines or not len(points):
        return False
    return _near(np.array(points, np.float64, order="C"), np.array(lines), gap, *here)


def backed_off(spot: Spot, points: Points, keep: float) -> Spot:
    """Return a spot that is `keep` (m) from the nearest sensed point, if there is room behind.

    Args:
        spot: north, east (m).
        points: (N, 3), m, NED, sensed.
        keep: distance to be kept (m).
    """
    away = np.array(spot) - points[np.isfinite(points).all(axis=1), :2]
    if not len(away):
        return spot
    gaps = np.hypot(away[:, 0], away[:, 1])
    near = int(gaps.argmin())
    if not 0.0 < gaps[near] < keep:
        return spot
    back = (keep / gaps[near] - 1.0) * away[near]
    moved = away + back
    if np.hypot(moved[:, 0], moved[:, 1]).min() <= gaps[near]:
        return spot
    return spot[0] + float(back[0]), spot[1] + float(back[1])


@compiled
def _walled(costs: Costs, lines: Mat) -> bool:
    """Say whether one of the lines (N, 4: row and column of both ends) meets a wall or the edge."""
    rows, columns = costs.shape
    for r0, c0, r1, c1 in lines:
        inside = 0.0 <= r0 < rows and 0.0 <= c0 < columns
        inside = inside and 0.0 <= r1 < rows and 0.0 <= c1 < columns
        if not inside or line_cost(costs, r0, c0, r1, c1) == math.inf:
            return True
    return False


@compiled
def _near(points: Points, lines: Mat, gap: float, north: float, east: float) -> bool:
    """Say whether one of the lines (N, 4: north and east of both ends) is too near to a point."""
    least = gap
    for n in range(len(points)):
        a, b = points[n, 0] - north, points[n, 1] - east
        if a * a + b * b < (least + NEARER) ** 2:
            least = max(0.0, math.sqrt(a * a + b * b) - NEARER)
    for line in lines:
        up, right = line[2] - line[0], line[3] - line[1]
        squared = max(up * up + right * right, 1e-12)
        for n in range(len(points)):
            a, b = points[n, 0] - line[0], points[n, 1] - line[1]
            share = min(1.0, max(0.0, (a * up + b * right) / squared))
            a, b = a - share * up, b - share * right
            if math.sqrt(a * a + b * b) < least:
                return True
    return False
