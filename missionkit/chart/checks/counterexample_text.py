"""Situations in words: one point of a box, with numbers a person would choose."""

from __future__ import annotations

import math

from missionkit.messages.region import Boxes, Interval, Quantity

QUANTITIES_SHOWN = 4  # quantities in a sentence


def example(boxes: Boxes) -> str:
    """Return a situation as words: "battery 0.15"; empty if any situation will do."""
    best = min(boxes, key=lambda box: (None in box.values(), len(box)), default={})
    parts = [_said(quantity, span) for quantity, span in best.items()]
    rest = len(parts) - QUANTITIES_SHOWN
    return ", ".join(parts[:QUANTITIES_SHOWN]) + (f" and {rest} more" if rest > 0 else "")


def at(boxes: Boxes) -> str:
    """Return "at battery 0.15", or "always"."""
    parts = example(boxes)
    return f"at {parts}" if parts else "always"


def _said(quantity: Quantity, span: Interval | None) -> str:
    if span is None:
        return f"unknown {quantity.name}"
    value = point(quantity, span)
    if quantity.words:
        return f"{quantity.name} '{quantity.words[int(value)]}'"
    if quantity.whole and (quantity.least, quantity.most) == (0.0, 1.0):
        return f"'{quantity.name}'" if value else f"no '{quantity.name}'"
    unit = f" {quantity.unit}" if quantity.unit else ""
    return f"{quantity.name} {value:g}{unit}"


def point(quantity: Quantity, span: Interval) -> float:
    """Return a value of the interval with few digits: in the middle, or near its finite end."""
    low, high = max(span.low, quantity.least), min(span.high, quantity.most)
    if low == high:
        return low
    if math.isinf(low) and math.isinf(high):
        return 0.0
    if quantity.whole:
        return _whole(low, high)
    if math.isinf(high):
        return low if not span.low_open or low != span.low else _beyond(low)
    if math.isinf(low):
        return high if not span.high_open or high != span.high else -_beyond(-high)
    return _short(low, high)


def _whole(low: float, high: float) -> float:
    return low if math.isfinite(low) else high


def _beyond(value: float) -> float:
    step = 1.0 if abs(value) >= 1.0 else 0.1
    further = round(value + step, 6)
    return further if further > value else math.nextafter(value, math.inf)


def _short(low: float, high: float) -> float:
    """Return the middle with as few digits as stay strictly between."""
    middle = low + (high - low) / 2.0
    for digits in range(17):
        short = round(middle, digits)
        if low < short < high:
            return short
    return middle
