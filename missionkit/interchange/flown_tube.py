"""The tube that many flights of one mission fill: quantiles across their common way, and in height.

Flights are compared state by state: each visit is divided into stations by its length, so that a
flight that hovers longer is not taken for one that is behind. At each station the distances of all
flights from the median, across its direction, and their heights give the quantiles: a share p of
the flights lies between the quantiles (1-p)/2 and (1+p)/2 of each. The two are taken apart, so
that a little less than p lies within both.

Source: R. Koenker, "Quantile Regression", 2005, section 1.3 (sample quantiles).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Points = npt.NDArray[np.float64]
Visit = tuple[str, int]  # a state, and which visit to it
STATION = 4.0  # m between stations
MOST_STATIONS = 60  # of one visit
LEAST_FLIGHTS = 2
LEVEL_MOTION = 0.25  # of the way: below it a leg is a climb, and has no direction
THINNEST = 0.02  # m, so that a face is seen where all flights agree


class Leg(NamedTuple):
    """One piece of the tube: the corners of its two ends, (4, 3) each, m, NED."""

    start: Points
    end: Points

    def faces(self) -> Iterator[Points]:
        """Yield its faces, (4, 3) each: both ends, and the four between them."""
        yield self.start
        yield self.end
        for one, other in ((0, 1), (1, 2), (2, 3), (3, 0)):
            yield np.array([self.start[one], self.start[other], self.end[other], self.end[one]])


def stations(path: Points, count: int) -> Points:
    """Return points that divide a path into equal lengths, (count, 3).

    Args:
        path: (N, 3), m.
        count: of the points, its ends among them.
    """
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    wanted = np.linspace(0.0, along[-1], count)
    return np.column_stack([np.interp(wanted, along, path[:, axis]) for axis in range(3)])


def tube(paths: Sequence[Points], share: float) -> list[Leg]:
    """Return the pieces of the tube of one visit.

    Args:
        paths: of the flights, (N, 3) each, m, NED.
        share: of the flights inside, 0 to 1.
    """
    length = float(np.median([_length(path) for path in paths]))
    count = int(np.clip(np.ceil(length / STATION) + 1, 2, MOST_STATIONS))
    points = np.stack([stations(path, count) for path in paths])  # flight, station, axis
    middle = np.median(points, axis=0)
    low, high = 0.5 * (1.0 - share), 0.5 * (1.0 + share)
    found = []
    for at in range(count - 1):
        way = middle[at + 1] - middle[at]
        level = float(np.hypot(way[0], way[1]))
        if level < LEVEL_MOTION * float(np.linalg.norm(way)) or level == 0.0:
            found.append(_column(points[:, at : at + 2], (low, high)))
        else:
            along = way[:2] / level
            ends = [_gate(points[:, it], middle[it], along, (low, high)) for it in (at, at + 1)]
            found.append(Leg(*ends))
    return found


def _length(path: Points) -> float:
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def _gate(points: Points, middle: Points, along: Points, between: tuple[float, float]) -> Points:
    """Return the corners of the rectangle across the way that a share of the flights passes."""
    right = np.array([-along[1], along[0]])
    across = (points[:, :2] - middle[:2]) @ right
    left, right_most = _range(across, between)
    top, bottom = _range(points[:, 2], between)
    spots = [middle[:2] + side * right for side in (left, right_most)]
    return np.array([[*spots[0], top], [*spots[1], top], [*spots[1], bottom], [*spots[0], bottom]])


def _column(points: Points, between: tuple[float, float]) -> Leg:
    """Return a piece in which the flights climb or descend: a box, north and east."""
    flat = points.reshape(-1, 3)
    (south, north), (west, east), (top, bottom) = (_range(flat[:, it], between) for it in range(3))
    ring = [(south, west), (south, east), (north, east), (north, west)]
    return Leg(*(np.array([[*corner, down] for corner in ring]) for down in (top, bottom)))


def _range(values: Points, between: tuple[float, float]) -> tuple[float, float]:
    least, most = (float(it) for it in np.quantile(values, between))
    missing = max(0.0, THINNEST - (most - least))
    return least - 0.5 * missing, most + 0.5 * missing


def by_visit(
    flights: Iterable[Sequence[tuple[str, Points]]],
) -> Mapping[Visit, list[Points]]:
    """Return the paths of all flights, visit by visit, in the order of the first that made each.

    Args:
        flights: of each flight the states it was in, one after the other, with the path in each.
    """
    found: dict[Visit, list[Points]] = {}
    for flight in flights:
        seen: dict[str, int] = {}
        for state, path in flight:
            seen[state] = seen.get(state, 0) + 1
            if len(path) > 1 and _length(path) > 0.0:
                found.setdefault((state, seen[state]), []).append(path)
    return {visit: paths for visit, paths in found.items() if len(paths) >= LEAST_FLIGHTS}
