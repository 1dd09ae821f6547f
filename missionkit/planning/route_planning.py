"""From a map, a start and a goal to a path in metres, or to a sentence why there is none.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.messages.occupancy import Costs, Occupancy, Spot
from missionkit.planning.astar import Cells, Heuristic, Neighbours, search
from missionkit.planning.map_inflation import inflated
from missionkit.planning.path_smoothing import (
    COST_SLACK,
    Corners,
    smoothed,
    straightened,
)

ESCAPE = 50.0  # a metre of the way out of the margin costs as much as so many in the open


class NoRouteError(ValueError):
    """Raised when there is no path; the message says why."""


class Way(NamedTuple):
    """How a path is to be."""

    margin: float = 0.0  # m, to keep from walls
    neighbours: Neighbours = 8
    heuristic: Heuristic | None = None
    smooth: bool = False  # straight lines where they are free


class Route(NamedTuple):
    """A path over level ground."""

    spots: tuple[Spot, ...]  # corners from start to goal
    length: float  # m
    cost: float  # what A* says it costs before it is smoothed (m)


def plan(known: Occupancy, start: Spot, goal: Spot, way: Way) -> Route:
    """Return the cheapest path.

    A start that is nearer to a wall than the margin, though not in it, is left by the shortest
    way; a goal there is refused.

    Args:
        known: map of walls and costs.
        start: m, north and east.
        goal: m, north and east.
        way: margin (m) and search options.

    Raises:
        NoRouteError: start or goal is off the map or in a wall, or nothing leads from one to the
            other.
    """
    for name, spot in (("start", start), ("goal", goal)):
        _require_free(known, name, spot)
    open_ = inflated(known.costs, way.margin / known.resolution)
    first, last = _index(known, start), _index(known, goal)
    if open_[last] == math.inf:
        raise NoRouteError(
            f"the goal {_shown(goal)} is nearer to a wall than the {way.margin:.2f} m to keep"
        )
    if open_[first] == math.inf:
        open_ = _with_a_way_out(known, open_, first, way.margin / known.resolution)
    cells, cost = search(open_, first, last, way.neighbours, way.heuristic)
    if not len(cells):
        raise NoRouteError(
            f"no way from {_shown(start)} to {_shown(goal)} that keeps {way.margin:.2f} m"
        )
    path = _through(cells, known.cell(start), known.cell(goal))
    corners = straightened(smoothed(open_, path) if way.smooth else path)
    spots = tuple(known.spot(row, column) for row, column in corners.tolist())
    return Route(spots, length_of(spots), cost * known.resolution)


def length_of(spots: tuple[Spot, ...]) -> float:
    """Return the length of a path (m)."""
    return sum(map(math.dist, spots[:-1], spots[1:]))


def _require_free(known: Occupancy, name: str, spot: Spot) -> None:
    if not known.covers(spot):
        raise NoRouteError(f"the {name} {_shown(spot)} is outside the map, which is {_area(known)}")
    if known.blocked(spot):
        raise NoRouteError(f"the {name} {_shown(spot)} is inside a wall")


def _with_a_way_out(known: Occupancy, open_: Costs, start: tuple[int, int], margin: float) -> Costs:
    """Open the margin's cells around the start that are as far from walls as the start."""
    gap = known.gap(known.spot(start[0] + 0.5, start[1] + 0.5)) / known.resolution
    costs = inflated(known.costs, gap - COST_SLACK)
    rows, columns = np.ogrid[: costs.shape[0], : costs.shape[1]]
    around = np.hypot(rows - start[0], columns - start[1]) <= 2.0 * margin + 1.0
    leave = around & np.isinf(open_) & np.isfinite(costs)
    return np.where(leave, ESCAPE * costs, open_)


def _index(known: Occupancy, spot: Spot) -> tuple[int, int]:
    row, column = known.cell(spot)
    return int(row), int(column)


def _through(cells: Cells, start: Spot, goal: Spot) -> Corners:
    """Return the centres of the cells between, and the exact ends."""
    if len(cells) == 1:
        return np.array([start, goal])
    return np.concatenate(([start], cells[1:-1] + 0.5, [goal]))


def _shown(spot: Spot) -> str:
    return f"({spot[0]:.2f}, {spot[1]:.2f})"


def _area(known: Occupancy) -> str:
    rows, columns = known.costs.shape
    corners = [known.spot(row, column) for row in (0, rows) for column in (0, columns)]
    north, east = zip(*corners, strict=True)
    return f"{min(north):.2f} to {max(north):.2f} north, {min(east):.2f} to {max(east):.2f} east"
