"""How long each active state has lasted, as intervals that time moves together.

Ages are intervals from `low` up to, but not with, `high`; equal ends are one point. Every answer
is an over-approximation: the hull of what is possible for each clock, not for all of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import product
from typing import NamedTuple

TICK = 0.1  # s between two ticks at most: a time may be noticed that much late


class Age(NamedTuple):
    """How long a state has lasted (s)."""

    low: float
    high: float


Ages = Mapping[str, Age]
Limits = Mapping[str, tuple[float, ...]]  # ages (s) of a state that decide something, ascending
ENTERED = Age(0.0, 0.0)


def following(age: float, limits: tuple[float, ...]) -> float:
    """Return the next limit after an age, infinity if there is none."""
    return next((limit for limit in limits if limit > age), math.inf)


def resting(ages: Ages, limits: Limits) -> dict[str, Age]:
    """Return the ages while nothing happens, until the first limit is reached."""
    left = _left(ages, limits)
    return {
        name: Age(low, min(high + left, following(low, limits[name])))
        for name, (low, high) in ages.items()
    }


def passed(ages: Ages, limits: Limits) -> Iterator[tuple[float, dict[str, Age]]]:
    """Yield what time alone leads to: s from now at least, and the ages then."""
    left = _left(ages, limits)
    for name, (low, high) in ages.items():
        limit = following(low, limits[name])
        if math.isinf(limit):
            continue
        least, most = max(0.0, limit - high), min(limit - low, left)
        if least > most:
            continue
        later = {
            other: Age(limit, limit + TICK)
            if other == name
            else Age(age.low + least, age.high + most + TICK)
            for other, age in ages.items()
        }
        for part in split(later, limits):
            yield least, part


def _left(ages: Ages, limits: Limits) -> float:
    """Return the time (s) in which some limit is reached at the latest."""
    return min((following(low, limits[name]) - low for name, (low, _) in ages.items()), default=0.0)


def split(ages: Ages, limits: Limits) -> Iterator[dict[str, Age]]:
    """Yield the ages in parts in which no limit lies."""
    parts = [list(_parts(age, limits[name])) for name, age in ages.items()]
    for each in product(*parts):
        yield dict(zip(ages, each, strict=True))


def _parts(age: Age, limits: tuple[float, ...]) -> Iterator[Age]:
    low, high = age
    if not limits or low >= limits[-1]:
        yield Age(limits[-1] if limits else 0.0, math.inf)
        return
    for limit in limits:
        if low < limit < high:
            yield Age(low, limit)
            low = limit
    yield Age(low, high) if low < limits[-1] else Age(low, math.inf)


def widened(ages: Ages, limits: Limits) -> dict[str, Age]:
    """Return all ages between the same limits."""
    return {
        name: Age(
            max((limit for limit in limits[name] if limit <= low), default=0.0),
            following(low, limits[name]),
        )
        for name, (low, _) in ages.items()
    }


def inside(ages: Ages, others: Ages) -> bool:
    """Say whether ages lie within others."""
    return all(
        others[name].low <= low and high <= others[name].high for name, (low, high) in ages.items()
    )
