"""Whether a path that was free still is.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from missionkit.messages import Occupancy, Points, Spot
from missionkit.planning.smoothing import line_cost

NEARER = 0.05  # m, more than the noise of a scan


def walled(known: Occupancy, pieces: Iterable[tuple[Spot, Spot]]) -> bool:
    """Say whether a piece of a path leads through a wall of the map or off it."""
    for start, end in pieces:
        if not (known.covers(start) and known.covers(end)):
            return True
        if line_cost(known.costs, *known.cell(start), *known.cell(end)) == math.inf:
            return True
    return False


def in_the_way(points: Points, pieces: Iterable[tuple[Spot, Spot]], gap: float, here: Spot) -> bool:
    """Say whether a path comes too near to something sensed.

    What is too near to the vehicle already is in the way only if the path leads nearer to it.

    Args:
        points: (N, 3), m, NED, sensed.
        pieces: of the path ahead.
        gap: to be kept (m).
        here: the vehicle.
    """
    level = points[:, :2]
    now = np.hypot(*(level - here).T)
    least = np.minimum(gap, now - NEARER)
    for start, end in pieces:
        way = np.subtract(end, start)
        share = np.clip((level - start) @ way / max(float(way @ way), 1e-12), 0.0, 1.0)
        off = level - start - share[:, None] * way
        if bool((np.hypot(*off.T) < least).any()):
            return True
    return False
