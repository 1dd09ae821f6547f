"""Fewer corners: a straight line wherever it is free and no dearer than the path it replaces.

Source: J. Amanatides, A. Woo, "A fast voxel traversal algorithm for ray tracing", 1987.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from missionkit.jit import compiled
from missionkit.messages.occupancy import Costs

Corners = npt.NDArray[np.float64]  # (N, 2), row and column; centres of cells are at halves
COST_SLACK = 1e-9


@compiled
def line_cost(costs: Costs, r0: float, c0: float, r1: float, c1: float) -> float:
    """Return the integral of the costs along a line (edges of cells), infinite through a wall.

    A line through the common corner of four cells needs those on both sides free.

    Args:
        costs: (rows, columns), infinite in walls.
        r0: row of the start, in cells.
        c0: column of the start.
        r1: row of the end.
        c1: column of the end.
    """
    row, column = math.floor(r0), math.floor(c0)
    last_row, last_column = math.floor(r1), math.floor(c1)
    up, right = r1 - r0, c1 - c0
    length = math.sqrt(up * up + right * right)
    down_step, side_step = 1 if up > 0.0 else -1, 1 if right > 0.0 else -1
    next_row = (row + (up > 0.0) - r0) / up if up != 0.0 else np.inf
    next_column = (column + (right > 0.0) - c0) / right if right != 0.0 else np.inf
    total, at = 0.0, 0.0
    for _ in range(abs(last_row - row) + abs(last_column - column) + 2):
        if costs[row, column] == np.inf:
            return np.inf
        ahead = min(1.0, next_row, next_column)
        total += (ahead - at) * length * costs[row, column]
        at = ahead
        if row == last_row and column == last_column:
            return float(total + (1.0 - at) * length * costs[row, column])
        gap = next_row - next_column
        if abs(gap) < COST_SLACK and row != last_row and column != last_column:
            if costs[row + down_step, column] == np.inf or costs[row, column + side_step] == np.inf:
                return np.inf
            row, column = row + down_step, column + side_step
            next_row, next_column = next_row + abs(1.0 / up), next_column + abs(1.0 / right)
        elif (gap < 0.0 and row != last_row) or column == last_column:
            row, next_row = row + down_step, next_row + abs(1.0 / up)
        else:
            column, next_column = column + side_step, next_column + abs(1.0 / right)
    return np.inf


def smoothed(costs: Costs, corners: Corners) -> Corners:
    """Return a path through some of the corners, no dearer than the one through all.

    Args:
        costs: (rows, columns), infinite where blocked.
        corners: (N, 2) of a path that is free.
    """
    forth = corners[_kept(costs, corners)]
    back = np.ascontiguousarray(forth[::-1])
    return back[_kept(costs, back)][::-1]


@compiled
def _kept(costs: Costs, corners: Corners) -> npt.NDArray[np.int64]:
    """Return which corners stay: from each the path goes straight as far as it can."""
    count = corners.shape[0]
    kept = np.empty(count, np.int64)
    kept[0] = 0
    size, anchor, so_far = 1, 0, 0.0
    for n in range(1, count):
        a, b, c = corners[anchor], corners[n - 1], corners[n]
        leg = line_cost(costs, b[0], b[1], c[0], c[1])
        straight = line_cost(costs, a[0], a[1], c[0], c[1])
        if n - 1 > anchor and straight > so_far + leg + COST_SLACK:
            kept[size] = n - 1
            size, anchor, so_far = size + 1, n - 1, leg
        else:
            so_far = min(straight, so_far + leg)
    if count > 1:
        kept[size] = count - 1
        size += 1
    return kept[:size]


def straightened(corners: Corners) -> Corners:
    """Return the path without corners at which it does not turn."""
    if len(corners) < 3:
        return corners
    before, after = corners[1:-1] - corners[:-2], corners[2:] - corners[1:-1]
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turns = np.abs(cross) > COST_SLACK
    return corners[np.concatenate(([True], turns, [True]))]
