"""Walls made thicker, so that a path for a point keeps its distance.

    r = body + clearance + k sqrt(σ_map² + σ_position²)

P2 has 0.5 m of clearance and 0.1 m of uncertainty of the walls; the vehicle's own is added to it
as independent errors add.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from missionkit.jit import compiled
from missionkit.messages.occupancy import Costs


def margin(clearance: float, map_sd: float, position_sd: float, sigmas: float) -> float:
    """Return the distance (m) to keep from what the map says.

    Args:
        clearance: m, to keep from walls.
        map_sd: m, of the map.
        position_sd: m, of the vehicle.
        sigmas: standard deviations to add.
    """
    return clearance + sigmas * math.hypot(map_sd, position_sd)


def inflated(costs: Costs, radius: float) -> Costs:
    """Return costs with every cell blocked whose centre is nearer than `radius` to a wall.

    The distance is to the nearest blocked square, not to its centre. The edge of the map is no
    wall.

    Args:
        costs: (rows, columns), infinite where blocked.
        radius: edges of cells.
    """
    if radius <= 0.0:
        return costs
    wider = costs.copy()
    wider[_near(np.isinf(costs), radius)] = np.inf
    return wider


@compiled
def _level(walls: npt.NDArray[np.bool_], far: int) -> npt.NDArray[np.int64]:
    """Return how many columns away the nearest wall in the row is, more than `far` without one."""
    rows, columns = walls.shape
    level = np.empty((rows, columns), np.int64)
    for row in range(rows):
        last = -far - 1
        for column in range(columns):
            if walls[row, column]:
                last = column
            level[row, column] = column - last
        last = columns + far
        for column in range(columns - 1, -1, -1):
            if walls[row, column]:
                last = column
            level[row, column] = min(level[row, column], last - column)
    return level


@compiled
def _near(walls: npt.NDArray[np.bool_], radius: float) -> npt.NDArray[np.bool_]:
    """Say which cells are nearer than `radius` to a wall.

    Along each row the distance to the nearest wall is known after two sweeps; a cell is near if
    for a row at most `radius` away Pythagoras says so.
    """
    rows, columns = walls.shape
    reach = math.ceil(radius + 0.5)
    level = _level(walls, rows + columns + reach)
    near = np.zeros((rows, columns), np.bool_)
    for row in range(rows):
        for other in range(max(0, row - reach), min(rows, row + reach + 1)):
            up = max(0.0, abs(row - other) - 0.5)
            room = radius * radius - up * up
            if room <= 0.0:
                continue
            widest = math.sqrt(room) + 0.5  # columns, exclusive
            for column in range(columns):
                if level[other, column] < widest:
                    near[row, column] = True
    return near
