"""Convex hulls, widths and strips of polygons on the level.

Angles are headings: radians clockwise from north.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TypeAlias

from missionkit.messages.occupancy import Spot
from missionkit.polygons import Polygon, edges

Interval: TypeAlias = tuple[float, float]


def hull(polygon: Polygon) -> list[Spot]:
    """Return the convex hull of a polygon's corners.  Source: A. M. Andrew, 1979."""
    spots = sorted(set(polygon))

    def half(row: Sequence[Spot]) -> list[Spot]:
        kept: list[Spot] = []
        for c in row:
            while len(kept) > 1 and _left(kept[-2], kept[-1], c) <= 0.0:
                kept.pop()
            kept.append(c)
        return kept[:-1]

    return half(spots) + half(spots[::-1])


def _left(a: Spot, b: Spot, c: Spot) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def turned(spot: Spot, heading: float) -> Spot:
    """Return a spot along a heading and to the right of it (m)."""
    c, s = math.cos(heading), math.sin(heading)
    return spot[0] * c + spot[1] * s, spot[1] * c - spot[0] * s


def turned_back(spot: Spot, heading: float) -> Spot:
    """Return the spot, north and east, that is so far along a heading and to the right of it."""
    c, s = math.cos(heading), math.sin(heading)
    return spot[0] * c - spot[1] * s, spot[0] * s + spot[1] * c


def width(polygon: Polygon, heading: float) -> float:
    """Return the extent (m) of a polygon across a heading."""
    across = [turned(spot, heading)[1] for spot in polygon]
    return max(across) - min(across)


def strip(polygon: Polygon, low: float, high: float) -> list[Interval]:
    """Return what of a polygon lies between two values of the second axis, along the first.

    Exact: between neighbouring corners the polygon is a row of trapezoids.

    Args:
        polygon: (N, 2), simple.
        low: m.
        high: m, more than `low`.

    Returns:
        Disjoint intervals (m), in order.
    """
    levels = sorted({low, high, *(y for _, y in polygon if low < y < high)})
    found: list[Interval] = []
    for y0, y1 in pairwise(levels):
        middle = 0.5 * (y0 + y1)
        cut = [(a, b) for a, b in edges(polygon) if (a[1] > middle) != (b[1] > middle)]
        cut.sort(key=lambda side: _at(side, middle))
        for one, other in zip(cut[::2], cut[1::2], strict=True):
            least = min(_at(one, y0), _at(one, y1))
            found.append((least, max(_at(other, y0), _at(other, y1))))
    return _joined(found)


def _at(side: tuple[Spot, Spot], y: float) -> float:
    (x0, y0), (x1, y1) = side
    return x0 + (y - y0) * (x1 - x0) / (y1 - y0)


def _joined(intervals: list[Interval]) -> list[Interval]:
    joined: list[Interval] = []
    for low, high in sorted(intervals):
        if joined and low <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(high, joined[-1][1]))
        else:
            joined.append((low, high))
    return joined
