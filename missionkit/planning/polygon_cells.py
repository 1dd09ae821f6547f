"""Polygons as cells of a map."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from missionkit.messages.occupancy import Occupancy, Spot

Polygon = Sequence[Spot]
Grid = npt.NDArray[np.bool_]
Corner = npt.NDArray[np.float64]


def drawn(
    area: tuple[Spot, Spot],
    resolution: float,
    walls: Sequence[Polygon],
    weights: Sequence[tuple[Polygon, float]] = (),
) -> Occupancy:
    """Return a map of what is inside and outside of polygons.

    Args:
        area: south-west and north-east corner (m).
        resolution: edge of a cell (m).
        walls: blocked, with every cell they touch.
        weights: polygons and the cost of a metre in them, 1 elsewhere; the highest counts.
    """
    (south, west), (north, east) = area
    rows = max(1, round((north - south) / resolution))
    columns = max(1, round((east - west) / resolution))
    costs = np.ones((rows, columns))
    for polygon, cost in weights:
        touched = _touched(_scaled(polygon, area[0], resolution), rows, columns)
        costs[touched] = np.maximum(costs[touched], cost)
    for polygon in walls:
        costs[_touched(_scaled(polygon, area[0], resolution), rows, columns)] = np.inf
    return Occupancy(costs, resolution, area[0])


def _scaled(polygon: Polygon, origin: Spot, resolution: float) -> Corner:
    return (np.array(polygon) - origin) / resolution


def _touched(corners: Corner, rows: int, columns: int) -> Grid:
    """Return the cells that a polygon (N, 2) covers or cuts."""
    row, column = np.ogrid[0.5 : rows + 0.5, 0.5 : columns + 0.5]
    inside = np.zeros((rows, columns), np.bool_)
    cut = np.zeros((rows, columns), np.bool_)
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        inside ^= crossed(a, b, row, column)
        cut |= _cut(a, b, row, column)
    return inside | cut


def crossed(a: Corner, b: Corner, row: Corner, column: Corner) -> Grid:
    """Say for which points a ray along the row meets an edge (even-odd rule).

    Args:
        a: (2,), row and column, of the edge's begin.
        b: (2,), of its end.
        row: of the points.
        column: of the points.
    """
    if a[0] == b[0]:
        return np.zeros(np.broadcast(row, column).shape, np.bool_)
    between = (a[0] > row) != (b[0] > row)
    crossing: Grid = between & (column < a[1] + (row - a[0]) * (b[1] - a[1]) / (b[0] - a[0]))
    return crossing


def _cut(a: Corner, b: Corner, row: Corner, column: Corner) -> Grid:
    """Say which squares around the points an edge enters: no axis separates them."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    boxes = (
        (row + 0.5 > low[0])
        & (row - 0.5 < high[0])
        & (column + 0.5 > low[1])
        & (column - 0.5 < high[1])
    )
    up, right = b - a
    off = np.abs(right * (row - a[0]) - up * (column - a[1]))
    entered: Grid = boxes & (off < 0.5 * (abs(up) + abs(right)))
    return entered
