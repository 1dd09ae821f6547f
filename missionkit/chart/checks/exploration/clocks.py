"""How long each active state has lasted, as intervals that time moves together.

Ages are intervals from `low` up to, but not with, `high`; equal ends are one point. States that
were entered in the same tick have one age: they are a group. Every answer is an over-approximation:
the hull of what is possible for each group, not for all of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import product
from typing import NamedTuple

TICK = 0.1  # s between two ticks at most: a time may be noticed that much late
ROUNDING = 1e-9  # s


class Age(NamedTuple):
    """How long a state has lasted (s)."""

    low: float
    high: float
    group: int = -1  # of the states with the same age; -1: entered just now


Ages = Mapping[str, Age]
Limits = Mapping[str, tuple[float, ...]]  # ages (s) of a state that decide something, ascending
ENTERED = Age(0.0, 0.0)


class Group(NamedTuple):
    """States with one age, and the ages that decide something for any of them."""

    age: Age
    limits: tuple[float, ...]


def groups(ages: Ages, limits: Limits) -> dict[int, Group]:
    """Return the groups of some states by their numbers."""
    found: dict[int, Group] = {}
    for name, age in ages.items():
        known = found.get(age.group)
        if known is None:
            found[age.group] = Group(age, limits[name])
        elif known.limits != limits[name]:
            both = tuple(sorted({*known.limits, *limits[name]}))
            found[age.group] = Group(age, both)
    return found


def following(age: float, limits: tuple[float, ...]) -> float:
    """Return the next limit after an age, infinity if there is none."""
    return next((limit for limit in limits if limit > age), math.inf)


def resting(ages: Ages, limits: Limits) -> dict[str, Age]:
    """Return the ages while nothing happens, until the first limit is reached."""
    every = groups(ages, limits)
    left = _left(every)
    later = {
        number: Age(age.low, min(age.high + left, following(age.low, each)), number)
        for number, (age, each) in every.items()
    }
    return {name: later[age.group] for name, age in ages.items()}


def passed(ages: Ages, limits: Limits) -> Iterator[tuple[float, dict[str, Age]]]:
    """Yield what time alone leads to: s from now at least, and the ages then."""
    every = groups(ages, limits)
    left = _left(every)
    for number, (age, each) in every.items():
        limit = following(age.low, each)
        if math.isinf(limit):
            continue
        least, most = max(0.0, limit - age.high), min(limit - age.low, left)
        if least > most:
            continue
        later = {
            other: Age(limit, limit + TICK, other)
            if other == number
            else Age(its.low + least, its.high + most + TICK, other)
            for other, (its, _) in every.items()
        }
        for part in split({name: later[its.group] for name, its in ages.items()}, limits):
            yield least, part


def _left(every: Mapping[int, Group]) -> float:
    """Return the time (s) in which some limit is reached at the latest."""
    return min(
        (following(age.low, limits) - age.low for age, limits in every.values()), default=0.0
    )


def split(ages: Ages, limits: Limits) -> Iterator[dict[str, Age]]:
    """Yield the ages in parts in which no limit lies, their groups numbered from 0."""
    every = groups(ages, limits)
    numbers = {group: number for number, group in enumerate(every)}
    parts = [list(_parts(age, limits)) for age, limits in every.values()]
    for each in product(*parts):
        numbered = [Age(age.low, age.high, number) for number, age in enumerate(each)]
        yield {name: numbered[numbers[age.group]] for name, age in ages.items()}


def _parts(age: Age, limits: tuple[float, ...]) -> Iterator[Age]:
    low, high, _ = age
    if not limits or low >= limits[-1]:
        yield Age(limits[-1] if limits else 0.0, math.inf)
        return
    for limit in limits:
        if low < limit < high - ROUNDING:
            yield Age(low, limit)
            low = limit
    yield Age(low, high) if low < limits[-1] else Age(low, math.inf)


def widened(ages: Ages, limits: Limits) -> dict[str, Age]:
    """Return all ages between the same limits."""
    wide = {
        number: Age(
            max((limit for limit in each if limit <= age.low), default=0.0),
            following(age.low, each),
            number,
        )
        for number, (age, each) in groups(ages, limits).items()
    }
    return {name: wide[age.group] for name, age in ages.items()}


def inside(ages: Ages, others: Ages) -> bool:
    """Say whether ages lie within others, of the same states in the same groups."""
    return all(
        others[name].low <= age.low and age.high <= others[name].high for name, age in ages.items()
    )
