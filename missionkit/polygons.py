"""Polygons on the ground: corners as (north, east), m; the last corner joins the first.

Source: J. O'Rourke, "Computational Geometry in C", 2nd ed. 1998, sections 1.5 (crossing segments)
and 7.4 (point in polygon).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

Corner = tuple[float, float]  # m, north and east
Polygon = Sequence[Corner]

LEAST_AREA = 1e-3  # m²
MOST_CORNERS = 500
ON_EDGE = 1e-9  # m


def edges(polygon: Polygon) -> Iterator[tuple[Corner, Corner]]:
    """Yield the edges in order."""
    yield from zip(polygon, (*polygon[1:], polygon[0]), strict=True)


def contains(polygon: Polygon, spot: Corner) -> bool:
    """Say whether a spot is inside, by the number of edges that a ray from it crosses."""
    north, east = spot
    inside = False
    for (n1, e1), (n2, e2) in edges(polygon):
        if (e1 > east) != (e2 > east) and north < (n2 - n1) * (east - e1) / (e2 - e1) + n1:
            inside = not inside
    return inside


def margin(polygon: Polygon, spot: Corner) -> float:
    """Return the distance (m) of a spot to the nearest edge, negative outside."""
    away = min(_to_edge(spot, *edge) for edge in edges(polygon))
    if away < ON_EDGE:
        return 0.0
    return away if contains(polygon, spot) else -away


def area(polygon: Polygon) -> float:
    """Return the area (m²), positive if the corners go clockwise as seen from above."""
    return 0.5 * sum(n1 * e2 - n2 * e1 for (n1, e1), (n2, e2) in edges(polygon))


def cuts(polygon: Polygon, start: Corner, end: Corner) -> Iterator[float]:
    """Yield where on a line it meets an edge: 0 at its start, 1 at its end.

    Args:
        polygon: corners, m.
        start: of the line, north and east (m).
        end: of the line, north and east (m).
    """
    way = end[0] - start[0], end[1] - start[1]
    for a, b in edges(polygon):
        side = b[0] - a[0], b[1] - a[1]
        turn = _cross(way, side)
        if turn == 0.0:
            continue  # parallel: it meets the neighbours of this edge
        gap = a[0] - start[0], a[1] - start[1]
        share, along = _cross(gap, side) / turn, _cross(gap, way) / turn
        if 0.0 <= share <= 1.0 and 0.0 <= along <= 1.0:
            yield share


def unfit(polygon: Polygon) -> str:
    """Say why corners do not make a polygon, "" if they do."""
    count = len(polygon)
    if count < 3:
        return f"a polygon needs at least 3 corners, got {count}"
    if count > MOST_CORNERS:
        return f"a polygon may have {MOST_CORNERS} corners, got {count}"
    if repeated := _repeated(polygon):
        return repeated
    if (crossing := _crossing(polygon)) is not None:
        one, other = (f"{n + 1} to {(n + 1) % count + 1}" for n in crossing)
        return f"the edges {one} and {other} cross: give the corners in order around it"
    return "its corners lie on one line" if abs(area(polygon)) < LEAST_AREA else ""


def _repeated(polygon: Polygon) -> str:
    for n, (a, b) in enumerate(edges(polygon), 1):
        if a == b and n == len(polygon):
            return "the last corner repeats the first: leave it out"
        if a == b:
            return f"corners {n} and {n + 1} are the same"
    return ""


def inside_of(inner: Polygon, outer: Polygon) -> bool:
    """Say whether a polygon lies inside another; their edges may touch."""
    if any(margin(outer, corner) < 0.0 for corner in inner):
        return False
    for a, b in edges(inner):
        shares = sorted({0.0, 1.0, *cuts(outer, a, b)})
        middles = [0.5 * (one + other) for one, other in pairwise(shares)]
        if any(margin(outer, _between(a, b, share)) < 0.0 for share in middles):
            return False
    return True


def widened(polygon: Polygon, by: float) -> tuple[Corner, ...] | None:
    """Return the polygon with its edges moved outwards, None if it would overlap itself.

    Args:
        polygon: one that `unfit` finds nothing wrong with.
        by: m; negative: inwards.
    """
    if by == 0.0:
        return tuple(polygon)
    outwards = math.copysign(by, by * area(polygon))
    lines = [_moved(a, b, outwards) for a, b in edges(polygon)]
    before = (lines[-1], *lines[:-1])
    corners = tuple(_meeting(one, other) for one, other in zip(before, lines, strict=True))
    if unfit(corners) or area(corners) * area(polygon) < 0.0:
        return None
    inner, outer = (polygon, corners) if by > 0.0 else (corners, polygon)
    near = min(margin(outer, corner) for corner in inner)
    return corners if near >= abs(by) - 1e-6 and inside_of(inner, outer) else None


def _between(a: Corner, b: Corner, share: float) -> Corner:
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])


def _to_edge(spot: Corner, a: Corner, b: Corner) -> float:
    side = b[0] - a[0], b[1] - a[1]
    length = side[0] * side[0] + side[1] * side[1]
    along = (spot[0] - a[0]) * side[0] + (spot[1] - a[1]) * side[1]
    share = min(1.0, max(0.0, along / length)) if length else 0.0
    return math.hypot(spot[0] - a[0] - share * side[0], spot[1] - a[1] - share * side[1])


def _crossing(polygon: Polygon) -> tuple[int, int] | None:
    """Return two edges that meet other than at a corner they share."""
    every = list(edges(polygon))
    count = len(every)
    for i, one in enumerate(every):
        for j in range(i + 1, count):
            if j == i + 1 or (i == 0 and j == count - 1):
                if _folded(one, every[j]):
                    return i, j
            elif _meet(one, every[j]):
                return i, j
    return None


def _folded(one: tuple[Corner, Corner], other: tuple[Corner, Corner]) -> bool:
    """Say whether two neighbours lie on each other."""
    shared = one[1] if one[1] == other[0] else one[0]
    a = one[0] if shared == one[1] else one[1]
    b = other[1] if shared == other[0] else other[0]
    u, v = (a[0] - shared[0], a[1] - shared[1]), (b[0] - shared[0], b[1] - shared[1])
    return abs(_cross(u, v)) < ON_EDGE and u[0] * v[0] + u[1] * v[1] > 0.0


def _meet(one: tuple[Corner, Corner], other: tuple[Corner, Corner]) -> bool:
    (a, b), (c, d) = one, other
    turns = _turn(a, b, c), _turn(a, b, d), _turn(c, d, a), _turn(c, d, b)
    if turns[0] * turns[1] < 0.0 and turns[2] * turns[3] < 0.0:
        return True
    return min(_to_edge(c, a, b), _to_edge(d, a, b), _to_edge(a, c, d), _to_edge(b, c, d)) < ON_EDGE


def _turn(a: Corner, b: Corner, c: Corner) -> float:
    return _cross((b[0] - a[0], b[1] - a[1]), (c[0] - a[0], c[1] - a[1]))


def _cross(u: Corner, v: Corner) -> float:
    return u[0] * v[1] - u[1] * v[0]


def _moved(a: Corner, b: Corner, by: float) -> tuple[Corner, Corner]:
    """Return an edge moved to its left, as seen from above, by so much (m)."""
    length = math.dist(a, b)
    off = by * (b[1] - a[1]) / length, -by * (b[0] - a[0]) / length
    return (a[0] + off[0], a[1] + off[1]), (b[0] + off[0], b[1] + off[1])


def _meeting(one: tuple[Corner, Corner], other: tuple[Corner, Corner]) -> Corner:
    """Return where two lines meet; of neighbours on one line, where the second begins."""
    (a, b), (c, d) = one, other
    u, v = (b[0] - a[0], b[1] - a[1]), (d[0] - c[0], d[1] - c[1])
    turn = _cross(u, v)
    if abs(turn) < ON_EDGE:
        return c
    share = _cross((c[0] - a[0], c[1] - a[1]), v) / turn
    return a[0] + share * u[0], a[1] + share * u[1]
