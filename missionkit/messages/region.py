"""Regions in which guards hold, as intervals of the quantities they read.

Checks before a flight compare guards by what they declare here; nothing of it is used in the air.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal, NamedTuple


class Quantity(NamedTuple):
    """Something a guard reads: its name for people, its range, and its initial value."""

    name: str
    least: float = 0.0
    most: float = math.inf
    unit: str = ""
    whole: bool = False  # whole numbers only; a truth value is 0 or 1
    at_entry: Literal["kept", "zero", "unknown"] = "kept"  # when a state is entered
    sees: str = ""  # the target whose marker must be looked for
    words: tuple[str, ...] = ()  # names of the whole numbers


class Interval(NamedTuple):
    """Values between two ends, which are included unless they are open."""

    low: float = -math.inf
    high: float = math.inf
    low_open: bool = False
    high_open: bool = False

    @classmethod
    def below(cls, limit: float) -> Interval:
        """Return the values less than `limit`."""
        return cls(high=limit, high_open=True)

    @classmethod
    def above(cls, limit: float) -> Interval:
        """Return the values greater than `limit`."""
        return cls(low=limit, low_open=True)

    @classmethod
    def at_most(cls, limit: float) -> Interval:
        """Return the values up to and with `limit`."""
        return cls(high=limit)

    @classmethod
    def at_least(cls, limit: float) -> Interval:
        """Return the values from `limit` on."""
        return cls(low=limit)


ONLY_FALSE, ONLY_TRUE = Interval(0.0, 0.0), Interval(1.0, 1.0)  # of a truth value
Box = Mapping[Quantity, Interval | None]  # all of them at once; None: the quantity is not known
Boxes = tuple[Box, ...]  # any of them


class Region(NamedTuple):
    """Where a guard may hold, and where it certainly holds if that is less.

    A guard with memory, such as a latch, may hold where it does not certainly hold. A guard whose
    regions are over one quantity has that quantity as the value of its verdict.
    """

    may: Boxes
    surely: Boxes | None = None  # None: wherever it may

    @classmethod
    def of(cls, quantity: Quantity, interval: Interval) -> Region:
        """Return the region of a guard that compares one quantity."""
        return cls(({quantity: interval},))
