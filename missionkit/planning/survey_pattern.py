"""Parallel lines over an area or along a corridor, in the order in which they are flown.

The area is cut into strips of equal width, at most the spacing wide. Each line is as long as its
strip is, so that what the camera sees beside the line covers slanted edges too. Where a strip
falls into pieces, neighbouring pieces make cells (boustrophedon decomposition), which are flown
one after the other.

Sources: H. Choset, "Coverage of known spaces: the boustrophedon cellular decomposition", 2000;
the width of a convex polygon is least across one of its sides (G. Toussaint, "Solving geometric
problems with the rotating calipers", 1983).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Literal, NamedTuple, TypeAlias

from missionkit.messages.occupancy import Spot
from missionkit.planning.polygon_strips import (
    Interval,
    hull,
    strip,
    turned,
    turned_back,
    width,
)
from missionkit.polygons import Polygon, edges

Line: TypeAlias = tuple[Spot, Spot]
"""Start and end, in the order flown (m, north and east)."""
Corner: TypeAlias = Literal["north-east", "south-east", "south-west", "north-west"]
_DIRECTIONS: dict[Corner, Spot] = {
    "north-east": (1.0, 1.0),
    "south-east": (-1.0, 1.0),
    "south-west": (-1.0, -1.0),
    "north-west": (1.0, -1.0),
}
MOST_LINES = 2_000
SLIVER = 1e-9  # m, of width that is rounding and needs no line of its own


class _Piece(NamedTuple):
    """A line in the frame of the sweep."""

    along: Interval  # m
    across: float  # m


_Cell: TypeAlias = list[_Piece]


def best_heading(polygon: Polygon, spacing: float) -> float:
    """Return the heading (rad, from 0 up to π) of lines with the fewest turns, then the shortest.

    That of a side: of the hull, across which the area is least wide, or of the polygon itself,
    where another direction cuts a bent area into fewer pieces.

    Args:
        polygon: (N, 2), m, north and east.
        spacing: m, between lines.
    """
    sides = [*edges(hull(polygon)), *edges(polygon)]
    found = {round(math.atan2(b[1] - a[1], b[0] - a[0]) % math.pi, 9) % math.pi for a, b in sides}

    def cost(heading: float) -> tuple[int, float, float]:
        pieces = [piece for cell in _cells(polygon, spacing, heading) for piece in cell]
        length = sum(high - low for (low, high), _ in pieces)
        return len(pieces), round(length, 6), heading

    return min(found, key=cost)


def survey_lines(
    polygon: Polygon, spacing: float, heading: float, entry: Corner | Spot
) -> list[Line]:
    """Return the lines over an area, in the order and direction in which they are flown.

    Args:
        polygon: (N, 2), m, north and east; a simple one.
        spacing: m, at most, between two lines.
        heading: rad, along which the lines lie.
        entry: the corner at which to begin, or the spot to begin near.
    """
    left = _cells(polygon, spacing, heading)
    lines: list[Line] = []
    while left:
        ways = [(cell, way) for cell in left for way in _ways(cell, heading)]
        at = lines[-1][1] if lines else entry
        cell, way = min(ways, key=lambda it: _remoteness(it[1][0][0], at))
        left.remove(cell)
        lines += way
    return lines


def _remoteness(spot: Spot, entry: Corner | Spot) -> float:
    """Return how far (m) a spot is from another, or from a corner as seen from the middle."""
    if not isinstance(entry, str):
        return math.dist(spot, entry)
    north, east = _DIRECTIONS[entry]
    return -north * spot[0] - east * spot[1]


def corridor_lines(centre: Sequence[Spot], breadth: float, spacing: float) -> list[list[Spot]]:
    """Return the parallels of a line that cover a corridor, each flown the other way than the last.

    Args:
        centre: (N, 2), m, the middle of the corridor, two spots at least.
        breadth: m, of the corridor.
        spacing: m, at most, between two lines.

    Raises:
        ValueError: two spots are the same, or a bend is too tight for the breadth.
    """
    count = _count(breadth, spacing)
    step = breadth / count
    found = [_parallel(centre, (at - 0.5 * (count - 1)) * step) for at in range(count)]
    return [row[::-1] if at % 2 else row for at, row in enumerate(found)]


def extended(line: Line, more: float) -> Line:
    """Return a line that begins and ends `more` (m) further out."""
    (a, b), (c, d) = line
    length = math.dist(*line)
    if length == 0.0:
        return line
    north, east = more * (c - a) / length, more * (d - b) / length
    return (a - north, b - east), (c + north, d + east)


def _count(breadth: float, spacing: float) -> int:
    count = max(1, math.ceil((breadth - SLIVER) / spacing))
    if count > MOST_LINES:
        raise ValueError(
            f"{breadth:g} m at a spacing of {spacing:g} m are {count} lines: at most {MOST_LINES}"
        )
    return count


def _cells(polygon: Polygon, spacing: float, heading: float) -> list[_Cell]:
    """Return the pieces of the lines, those that follow each other in one cell."""
    swept = [turned(spot, heading) for spot in polygon]
    lowest, breadth = min(y for _, y in swept), width(polygon, heading)
    count = _count(breadth, spacing)
    step = breadth / count
    cells: list[_Cell] = []
    open_cells: list[_Cell] = []
    for at in range(count):
        low = lowest + at * step
        pieces = [_Piece(it, low + 0.5 * step) for it in strip(swept, low, low + step)]
        open_cells = _continued(open_cells, pieces)
        cells += [cell for cell in open_cells if len(cell) == 1]
    return cells


def _continued(before: list[_Cell], pieces: list[_Piece]) -> list[_Cell]:
    """Return the cells in which the pieces of the next strip lie, new ones where they do not fit.

    A piece goes on with the cell of the strip before if each of the two touches no other.
    """
    following: list[_Cell] = []
    for piece in pieces:
        touching = [cell for cell in before if _touch(cell[-1], piece)]
        alone = len(touching) == 1 and sum(_touch(touching[0][-1], it) for it in pieces) == 1
        if alone:
            following.append(touching[0])
        else:
            following.append([])
    for cell, piece in zip(following, pieces, strict=True):
        cell.append(piece)
    return following


def _touch(one: _Piece, other: _Piece) -> bool:
    return one.along[0] <= other.along[1] and other.along[0] <= one.along[1]


def _ways(cell: _Cell, heading: float) -> list[list[Line]]:
    """Return the four ways to fly a cell: from its first or last line, from either end."""
    found = []
    for rows in (cell, cell[::-1]):
        for first in (0, 1):
            way = []
            for count, piece in enumerate(rows):
                ends = piece.along if (count + first) % 2 == 0 else piece.along[::-1]
                start, end = (turned_back((x, piece.across), heading) for x in ends)
                way.append((start, end))
            found.append(way)
    return found


def _parallel(centre: Sequence[Spot], right: float) -> list[Spot]:
    """Return the line `right` (m) of another, its corners mitred."""
    ways = []
    for a, b in pairwise(centre):
        length = math.dist(a, b)
        if length == 0.0:
            raise ValueError("two neighbouring spots of the corridor are the same")
        ways.append(((b[0] - a[0]) / length, (b[1] - a[1]) / length))
    row = []
    for at, spot in enumerate(centre):
        before, after = ways[max(0, at - 1)], ways[min(at, len(ways) - 1)]
        cosine = before[0] * after[0] + before[1] * after[1]
        if cosine < -0.9:
            raise ValueError(f"the corridor turns back at spot {at + 1}: make it two")
        k = right / (1.0 + cosine)
        row.append((spot[0] - k * (before[1] + after[1]), spot[1] + k * (before[0] + after[0])))
    for at, ((a, b), way) in enumerate(zip(pairwise(row), ways, strict=True)):
        if (b[0] - a[0]) * way[0] + (b[1] - a[1]) * way[1] <= 0.0:
            raise ValueError(
                f"the corridor is too wide for its bend after spot {at + 1}: make it narrower"
            )
    return row
