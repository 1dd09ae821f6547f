"""Boxes: sets of situations in which each of some quantities lies in an interval.

A box says nothing about the quantities it does not name: they may have any value, or none. Every
answer here is exact, up to the caps that keep the time short; a cap always errs on the side that
its function says.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import lru_cache

from missionkit.messages.region import Box, Boxes, Interval, Quantity

EVERYWHERE: Boxes = ({},)
NO_BOXES: Boxes = ()
MOST_BOXES = 64
MOST_QUANTITIES = 24  # named by one box
MOST_PIECES = 256  # of a box, while others are cut out of it
MOST_SIDES = 4096  # of intervals, remembered
ALL_VALUES = Interval()


def within(quantity: Quantity, interval: Interval) -> Interval | None:
    """Return the part of an interval that the quantity can have, None if there is none."""
    cut = _met(interval, (quantity.least, quantity.most, False, False))
    if cut is None or not quantity.whole:
        return cut
    low = _up(cut.low, open_=cut.low_open)
    high = -_up(-cut.high, open_=cut.high_open)
    return Interval(low, high) if low <= high else None


def _up(value: float, *, open_: bool) -> float:
    """Return the least whole number from `value` on, or after it."""
    if math.isinf(value):
        return value
    return float(math.floor(value) + 1 if open_ else math.ceil(value))


def _met(one: Interval, other: tuple[float, float, bool, bool]) -> Interval | None:
    """Return what is in both: the first itself if that is all of it."""
    low, high, low_open, high_open = one
    least, most, least_open, most_open = other
    if least > low or (least == low and least_open):
        low, low_open = least, least_open
    if most < high or (most == high and most_open):
        high, high_open = most, most_open
    if low > high or (low == high and (low_open or high_open)) or low == math.inf:
        return None
    met = (low, high, low_open, high_open)
    return one if met == one else Interval._make(met)


def meet(one: Box, other: Box) -> Box | None:
    """Return the box of the situations in both, None if there are none."""
    both = dict(one)
    for quantity, there in other.items():
        if quantity not in both:
            both[quantity] = there
            continue
        here = both[quantity]
        if here is None or there is None:
            if here is not there:
                return None
            continue
        cut = _met(here, there)
        cut = None if cut is None else within(quantity, cut)
        if cut is None:
            return None
        both[quantity] = cut
    return both


def clipped(boxes: Iterable[Box]) -> Boxes:
    """Return the boxes that are not empty, each interval cut to what its quantity can have."""
    return tuple(box for box in map(_clipped, boxes) if box is not None)


def _clipped(box: Box) -> Box | None:
    cut: dict[Quantity, Interval | None] = {}
    for quantity, interval in box.items():
        inside = None if interval is None else within(quantity, interval)
        if interval is not None and inside is None:
            return None
        cut[quantity] = inside
    return cut


def intersection(one: Boxes, other: Boxes, *, sure: bool) -> Boxes:
    """Return the situations in both.

    Beyond the caps the answer is too small if it must be `sure`, else too large.

    Args:
        one: union of boxes.
        other: union of boxes.
        sure: whether the answer must hold no situation that is outside either set.
    """
    met: list[Box] = []
    for here in one:
        for there in other:
            box = meet(here, there)
            if box is None or box in met:
                continue
            if len(box) > MOST_QUANTITIES:
                box = None if sure else here
            if box is not None:
                met.append(box)
            if len(met) > MOST_BOXES:
                return tuple(met[:MOST_BOXES]) if sure else one
    return tuple(met)


def union(parts: Iterable[Boxes], *, sure: bool) -> Boxes:
    """Return the situations in any of them; beyond the cap as `intersection`."""
    found: list[Box] = []
    for boxes in parts:
        for box in boxes:
            if not box:
                return EVERYWHERE
            if box not in found:
                found.append(box)
        if len(found) > MOST_BOXES:
            return tuple(found[:MOST_BOXES]) if sure else EVERYWHERE
    return tuple(found)


def outside(box: Box) -> Boxes:
    """Return where a box does not hold although the quantity that says so is known."""
    sides: list[Box] = []
    for quantity, interval in box.items():
        if interval is not None:
            sides += [{quantity: side} for side in _sides(quantity, ALL_VALUES, interval)]
    return tuple(sides)


@lru_cache(MOST_SIDES)
def _sides(quantity: Quantity, one: Interval, other: Interval) -> tuple[Interval, ...]:
    """Return what of `one` lies below and above `other`."""
    below = (-math.inf, other.low, False, not other.low_open)
    above = (other.high, math.inf, not other.high_open, False)
    cuts = (_met(one, side) for side in (below, above))
    inside = (within(quantity, cut) for cut in cuts if cut is not None)
    return tuple([cut for cut in inside if cut is not None])


def difference(box: Box, other: Box) -> list[Box]:
    """Return the situations in `box` but not in `other`, in boxes that do not overlap."""
    if meet(box, other) is None:
        return [box]
    pieces: list[Box] = []
    rest = dict(box)
    for quantity, there in other.items():
        here = rest.get(quantity)
        if quantity not in rest:
            pieces += [{**rest, quantity: side} for side in _unnamed(quantity, there)]
            rest[quantity] = there
        elif here is not None and there is not None:
            pieces += [{**rest, quantity: side} for side in _sides(quantity, here, there)]
            rest[quantity] = _met(here, there)
    return pieces


@lru_cache(MOST_SIDES)
def _unnamed(quantity: Quantity, there: Interval | None) -> tuple[Interval | None, ...]:
    """Return what any or no value of a quantity leaves beside `there`."""
    if there is None:
        return (within(quantity, ALL_VALUES),)
    return (None, *_sides(quantity, ALL_VALUES, there))


def remains(boxes: Boxes, cut: Boxes) -> Boxes | None:
    """Return what of `boxes` is in none of `cut`; None beyond the cap: undecided."""
    pieces = list(boxes)
    for other in cut:
        pieces = [piece for box in pieces for piece in difference(box, other)]
        if len(pieces) > MOST_PIECES:
            return None
    return tuple(pieces)


def covered(boxes: Boxes, by: Boxes) -> bool:
    """Say whether every situation in `boxes` is in one of `by`; False if undecided."""
    return all(_covered(box, by) for box in boxes)


def _covered(box: Box, by: Boxes) -> bool:
    if any(_contains(other, box) for other in by):
        return True
    near = tuple(other for other in by if meet(box, other) is not None) if len(by) > 1 else ()
    return len(near) > 1 and remains((box,), near) == ()


def kept_at_entry(boxes: Boxes) -> Boxes:
    """Return what boxes say of the world outside, which entering a state does not change."""
    return tuple(
        {quantity: span for quantity, span in box.items() if quantity.at_entry == "kept"}
        for box in boxes
    )


def _contains(outer: Box, inner: Box) -> bool:
    for quantity, there in outer.items():
        if quantity not in inner:
            return False
        here = inner[quantity]
        if here is None or there is None:
            if here is not there:
                return False
        elif _met(here, there) != here:
            return False
    return True
