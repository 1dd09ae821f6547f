"""The ways of surveys and corridors, as a mission flies them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise

from missionkit.geodesy import Origin
from missionkit.geometry import vec
from missionkit.interchange.plan import Corridor, LatLon, Survey, degrees
from missionkit.planning.survey_pattern import (
    best_heading,
    corridor_lines,
    extended,
    survey_lines,
)

Metres = tuple[float, float]  # north, east


def local(spots: Iterable[LatLon], origin: Origin) -> tuple[Metres, ...]:
    """Return places as north, east (m)."""
    points = (origin.local(it.lat, it.lon, origin.altitude) for it in spots)
    return tuple((float(north), float(east)) for north, east, _ in points)


def earth(points: Iterable[Metres], origin: Origin) -> tuple[LatLon, ...]:
    """Return points north, east (m) as places."""
    places = (origin.place(vec(*it, 0.0)) for it in points)
    return tuple(LatLon(degrees(lat), degrees(lon)) for lat, lon, _ in places)


def flown(
    action: Survey | Corridor, origin: Origin, entry: Metres = (0.0, 0.0)
) -> tuple[Metres, ...]:
    """Return where the lines lead, north and east (m), with what it needs to turn.

    Args:
        action: with its spacing.
        origin: of the metres.
        entry: m, where the vehicle comes from.

    Raises:
        ValueError: the area or the line cannot be flown so; the message says why.
    """
    spacing = action.spacing or 0.0
    lines: Sequence[Sequence[Metres]]
    if isinstance(action, Corridor):
        lines = corridor_lines(local(action.line, origin), action.breadth, spacing)
    else:
        area = local(action.polygon, origin)
        given = action.angle
        heading = best_heading(area, spacing) if given is None else math.radians(given)
        lines = survey_lines(area, spacing, heading, entry)
    points: list[Metres] = []
    for line in lines:
        first, _ = extended((line[0], line[1]), action.turn_around)
        _, last = extended((line[-2], line[-1]), action.turn_around)
        points += [first, *line[1:-1], last]
    return tuple(points)


def deviation(given: Sequence[LatLon], path: Sequence[Metres], origin: Origin) -> float:
    """Return how far (m) places lie from a path, at most.

    Args:
        given: the places.
        path: m, north and east of the origin.
        origin: of the path.
    """
    legs = list(pairwise(path))
    return max(min(_to_leg(it, *leg) for leg in legs) for it in local(given, origin))


def _to_leg(spot: Metres, start: Metres, end: Metres) -> float:
    way = end[0] - start[0], end[1] - start[1]
    length = way[0] ** 2 + way[1] ** 2
    gap = spot[0] - start[0], spot[1] - start[1]
    share = (gap[0] * way[0] + gap[1] * way[1]) / length if length else 0.0
    share = min(1.0, max(0.0, share))
    return math.hypot(gap[0] - share * way[0], gap[1] - share * way[1])
