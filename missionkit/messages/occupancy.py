"""A known map: what a metre costs in each cell of a grid."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import numpy.typing as npt

Costs = npt.NDArray[np.float64]  # (rows, columns), at least 1; infinite: blocked
Spot = tuple[float, float]
"""North, east (m)."""


@dataclass(frozen=True, slots=True, eq=False)
class Occupancy:
    """A grid over level ground. Rows lead to the north and columns to the east, unless turned.

    n = n₀ + u sin θ + v cos θ,   e = e₀ + u cos θ - v sin θ,
    with u along the columns and v along the rows: the map frame of ROS, x = u, y = v.
    """

    costs: Costs
    resolution: float  # m, edge of a cell
    origin: Spot  # m, outer corner of cell [0, 0]
    turned: float = 0.0  # rad, θ, counter-clockwise seen from above

    def cell(self, spot: Spot) -> tuple[float, float]:
        """Return the row and column of a place as numbers: cell [0, 0] covers 0 to 1 on both."""
        n, e = spot[0] - self.origin[0], spot[1] - self.origin[1]
        s, c = math.sin(self.turned), math.cos(self.turned)
        return (c * n - s * e) / self.resolution, (s * n + c * e) / self.resolution

    def spot(self, row: float, column: float) -> Spot:
        """Return the place of a row and column; the centre of cell [0, 0] is at 0.5, 0.5."""
        v, u = row * self.resolution, column * self.resolution
        s, c = math.sin(self.turned), math.cos(self.turned)
        return self.origin[0] + u * s + v * c, self.origin[1] + u * c - v * s

    def covers(self, spot: Spot) -> bool:
        """Say whether a place is on the map."""
        row, column = self.cell(spot)
        rows, columns = self.costs.shape
        return bool(0.0 <= row < rows and 0.0 <= column < columns)

    def blocked(self, spot: Spot) -> bool:
        """Say whether a place on the map is inside a wall."""
        row, column = self.cell(spot)
        return bool(self.costs[int(row), int(column)] == math.inf)

    def unfit_start(self, spot: Spot) -> str:
        """Say why no path can start from a place; "" if one can."""
        if not self.covers(spot):
            return "outside the map"
        return "inside a wall of the map" if self.blocked(spot) else ""

    def gap(self, spot: Spot) -> float:
        """Return the distance (m) from a place to the nearest blocked cell; infinite: none."""
        row, column = self.cell(spot)
        rows, columns = np.nonzero(np.isinf(self.costs))
        if not len(rows):
            return math.inf
        up = np.maximum(np.abs(rows + 0.5 - row) - 0.5, 0.0)
        side = np.maximum(np.abs(columns + 0.5 - column) - 0.5, 0.0)
        return float(np.hypot(up, side).min()) * self.resolution

    def with_walls(self, spots: Iterable[Spot]) -> Self:
        """Return the map with the cells at some places blocked; those off the map do not matter."""
        cells = [self.cell(spot) for spot in spots if self.covers(spot)]
        if not cells:
            return self
        rows, columns = np.array(cells, np.int64).T
        costs = self.costs.copy()
        costs[rows, columns] = np.inf
        return replace(self, costs=costs)
