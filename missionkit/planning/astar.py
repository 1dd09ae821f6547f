"""The shortest path over a grid: A* with 4 or 8 neighbours (P2, section II).

    f(n) = g(n) + h(n),   g(s) = g(p) + |s - p| (c_p + c_s) / 2

with c the cost of a metre in a cell: P2's cost map; 1 everywhere is its binary map. Against the
printed pseudocode the search ends when the goal is taken off the open list, not when it is first
seen, and what is closed is not opened again unless it became nearer (corrections P2.1, P2.2). A
diagonal move needs both cells beside it free: no corner is cut. Among ways that
cost the same those with fewer turns are preferred.

Source: P. Hart, N. Nilsson, B. Raphael, "A formal basis for the heuristic determination of
minimum cost paths", 1968.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import numpy.typing as npt

from missionkit.jit import compiled
from missionkit.messages.occupancy import Costs

Heuristic = Literal["manhattan", "euclidean", "octile"]
Neighbours = Literal[4, 8]
Cells = npt.NDArray[np.int64]  # (N, 2), row and column
Flags = npt.NDArray[np.int8]
MANHATTAN, EUCLIDEAN, OCTILE = 0, 1, 2
HEURISTIC_NUMBERS: dict[Heuristic, int] = {
    "manhattan": MANHATTAN,
    "euclidean": EUCLIDEAN,
    "octile": OCTILE,
}
DIAGONAL = math.sqrt(2.0)
NOBODY = -1
EQUAL = 1e-9  # edges of cells; rounding of sums

# the orthogonal moves first; the diagonal ones each between two of them
ROW_STEPS = (0, 1, 0, -1, 1, 1, -1, -1)
COLUMN_STEPS = (1, 0, -1, 0, 1, -1, -1, 1)


def search(
    costs: Costs,
    start: tuple[int, int],
    goal: tuple[int, int],
    neighbours: Neighbours = 8,
    heuristic: Heuristic | None = None,
) -> tuple[Cells, float]:
    """Return the cells of the cheapest path and what it costs (edges of cells).

    Args:
        costs: (rows, columns), positive, infinite where blocked.
        start: row, column.
        goal: row, column.
        neighbours: of a cell.
        heuristic: by default the tightest: `manhattan` for 4 neighbours, `octile` for 8.

    Returns:
        No cells and infinity when there is no path.

    Raises:
        ValueError: Manhattan distance with diagonal moves, which it overestimates.
    """
    chosen = heuristic or ("manhattan" if neighbours == 4 else "octile")
    if neighbours == 8 and chosen == "manhattan":
        raise ValueError("'manhattan' overestimates diagonal moves; use 'octile' or 'euclidean'")
    costs = np.ascontiguousarray(costs, np.float64)
    if math.inf in {float(costs[start]), float(costs[goal])}:
        return np.empty((0, 2), np.int64), math.inf
    least = float(costs.min())
    columns = costs.shape[1]
    first, last = start[0] * columns + start[1], goal[0] * columns + goal[1]
    parents, cost = _search(costs, first, last, neighbours, HEURISTIC_NUMBERS[chosen], least)
    if cost == math.inf:
        return np.empty((0, 2), np.int64), math.inf
    return _traced(parents, first, last, columns), float(cost)


@compiled
def _distance(kind: int, rows: int, columns: int) -> float:
    """Return the heuristic's distance over so many rows and columns."""
    a, b = abs(rows), abs(columns)
    if kind == MANHATTAN:
        return float(a + b)
    if kind == EUCLIDEAN:
        return math.sqrt(float(a * a + b * b))
    return max(a, b) + (DIAGONAL - 1.0) * min(a, b)


@compiled
def _push(keys: Costs, cells: npt.NDArray[np.int64], size: int, key: float, cell: int) -> None:
    """Put a cell into the binary heap of `size` others, before those with the same key."""
    at = size
    while at > 0:
        above = (at - 1) >> 1
        if keys[above] < key:
            break
        keys[at], cells[at] = keys[above], cells[above]
        at = above
    keys[at], cells[at] = key, cell


@compiled
def _pop(keys: Costs, cells: npt.NDArray[np.int64], size: int) -> int:
    """Take the cell with the least key off the heap of `size`."""
    least = cells[0]
    size -= 1
    key, cell = keys[size], cells[size]
    at, below = 0, 1
    while below < size:
        if below + 1 < size and keys[below + 1] < keys[below]:
            below += 1
        if key <= keys[below]:
            break
        keys[at], cells[at] = keys[below], cells[below]
        at, below = below, 2 * below + 1
    keys[at], cells[at] = key, cell
    return int(least)


@compiled
def _grown(keys: Costs, cells: npt.NDArray[np.int64]) -> tuple[Costs, npt.NDArray[np.int64]]:
    """Return the heap with twice the room."""
    more = np.empty(2 * keys.shape[0])
    more[: keys.shape[0]] = keys
    cells_more = np.empty(2 * cells.shape[0], np.int64)
    cells_more[: cells.shape[0]] = cells
    return more, cells_more


@compiled
def _step(costs: Costs, row: int, column: int, move: int) -> float:
    """Return what a move costs (edges of cells), infinite where it cannot be made."""
    r, c = row + ROW_STEPS[move], column + COLUMN_STEPS[move]
    if r < 0 or c < 0 or r >= costs.shape[0] or c >= costs.shape[1]:
        return np.inf
    length = 0.5
    if move >= 4:
        if costs[r, column] == np.inf or costs[row, c] == np.inf:
            return np.inf
        length = 0.5 * DIAGONAL
    return float(length * (costs[row, column] + costs[r, c]))


@compiled
def _search(
    costs: Costs, first: int, last: int, neighbours: int, kind: int, least: float
) -> tuple[Flags, float]:
    """Return by which move each cell was reached, and the cost of the goal (edges of cells)."""
    columns = costs.shape[1]
    goal_row, goal_column = last // columns, last % columns
    lengths = np.full(costs.size, np.inf)  # g
    parents = np.full(costs.size, NOBODY, np.int8)
    closed = np.zeros(costs.size, np.int8)
    keys, cells = np.empty(1024), np.empty(1024, np.int64)
    lengths[first] = 0.0
    _push(keys, cells, 0, 0.0, first)
    size = 1
    while size > 0 and not closed[last]:
        here = _pop(keys, cells, size)
        size -= 1
        if closed[here]:
            continue
        closed[here] = 1
        row, column = here // columns, here % columns
        if size + 8 > keys.shape[0]:
            keys, cells = _grown(keys, cells)
        for move in range(neighbours):
            length = lengths[here] + _step(costs, row, column, move)
            if length == np.inf:
                continue
            r, c = row + ROW_STEPS[move], column + COLUMN_STEPS[move]
            there = r * columns + c
            if length >= lengths[there]:
                if parents[here] == move and length < lengths[there] + EQUAL:
                    parents[there] = move
            else:
                lengths[there] = length
                parents[there] = move
                closed[there] = 0
                guess = least * _distance(kind, r - goal_row, c - goal_column)
                _push(keys, cells, size, length + guess, there)
                size += 1
    return parents, lengths[last]


def _traced(parents: Flags, first: int, last: int, columns: int) -> Cells:
    """Return the path (N, 2) from the first cell to the last."""
    path = [last]
    while path[-1] != first:
        move = parents[path[-1]]
        path.append(path[-1] - ROW_STEPS[move] * columns - COLUMN_STEPS[move])
    cells = np.array(path[::-1])
    return np.stack((cells // columns, cells % columns), axis=1)
