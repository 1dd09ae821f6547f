"""Along a path: how far one is, what comes next, how fast one may go there."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

from missionkit.messages.occupancy import Spot

CORNER_SPEED = 0.1  # m/s, through the sharpest corner
REACH = 1.0  # m, how far along the path the nearest point is looked for


class Leg(NamedTuple):
    """A straight part of a path."""

    begins: float  # m along the path
    length: float  # m
    start: Spot
    way: Spot  # unit vector

    def at(self, along: float) -> Spot:
        """Return the spot so many metres along the path."""
        far = min(self.length, max(0.0, along - self.begins))
        return self.start[0] + far * self.way[0], self.start[1] + far * self.way[1]


@lru_cache(maxsize=16)  # evaluated at every tick
def legs(spots: tuple[Spot, ...]) -> tuple[Leg, ...]:
    """Return the parts of a path through `spots` that have a length."""
    found: list[Leg] = []
    begins = 0.0
    for a, b in pairwise(spots):
        length = math.dist(a, b)
        if length > 0.0:
            way = (b[0] - a[0]) / length, (b[1] - a[1]) / length
            found.append(Leg(begins, length, a, way))
            begins += length
    return tuple(found)


def leg_at(path: tuple[Leg, ...], along: float) -> Leg:
    """Return the part of a path at a distance along it; at a corner the one after."""
    return next((leg for leg in path if along < leg.begins + leg.length), path[-1])


def nearest(path: tuple[Leg, ...], along: float, spot: Spot) -> float:
    """Return how far along (m) the nearest point of the path is, from `along` to a reach ahead.

    Args:
        path: its legs, in order.
        along: m, where the vehicle was on it.
        spot: (2,), m, north and east.
    """
    best, least = along, math.inf
    for leg in path:
        if leg.begins > along + REACH:
            break
        low, high = max(along, leg.begins), min(along + REACH, leg.begins + leg.length)
        if low > high:
            continue
        a, b = spot[0] - leg.start[0], spot[1] - leg.start[1]
        at = min(high, max(low, leg.begins + a * leg.way[0] + b * leg.way[1]))
        gap = math.dist(leg.at(at), spot)
        if gap < least - 1e-9:
            best, least = at, gap
    return best


def allowed_speed(path: tuple[Leg, ...], along: float, top: float, deceleration: float) -> float:
    """Return the speed (m/s) from which every corner ahead and the end are met slowly enough.

    v² = v_c² + 2 a d, with v_c = `top` cos θ at a corner that turns by θ, and 0 at the end.

    Args:
        path: its legs, in order.
        along: m, where the vehicle is on it.
        top: m/s.
        deceleration: a, m/s².
    """
    speed = top
    for before, after in pairwise((*path, None)):
        if before is None:
            break
        ahead = before.begins + before.length - along
        if ahead < 0.0:
            continue
        if 2.0 * deceleration * ahead >= speed * speed:
            break  # nothing so far ahead slows it down
        slow = 0.0
        if after is not None:
            cosine = before.way[0] * after.way[0] + before.way[1] * after.way[1]
            slow = max(CORNER_SPEED, top * cosine)
        speed = min(speed, math.sqrt(slow * slow + 2.0 * deceleration * ahead))
    return min(top, max(CORNER_SPEED, speed))


def pieces(path: tuple[Leg, ...], along: float, reach: float) -> Iterator[tuple[Spot, Spot]]:
    """Yield the straight pieces of a path from `along` to `reach` (m) further.

    Args:
        path: its legs, in order.
        along: m, where to begin.
        reach: m.
    """
    for leg in path:
        if leg.begins > along + reach:
            break
        low, high = max(along, leg.begins), min(along + reach, leg.begins + leg.length)
        if low < high:
            yield leg.at(low), leg.at(high)
