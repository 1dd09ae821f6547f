"""The quantities that the guards of a chart read, as sliders."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import NamedTuple

from missionkit.chart.checks.exploration.point_guards import PointGuard
from missionkit.chart.checks.guard_regions import GuardRegion
from missionkit.messages.region import Boxes, Interval, Quantity

FAR = 1e6  # what is beyond is as good as endless


class Slider(NamedTuple):
    """A quantity, and between which values it is set."""

    quantity: Quantity
    low: float
    high: float
    thresholds: tuple[float, ...]  # of guards, from the least on

    @property
    def name(self) -> str:
        """Its name, by which the page sets it."""
        return self.quantity.name

    def value(self, value: float) -> float:
        """Return the nearest value that it can have."""
        near = min(max(value, self.low), self.high)
        return float(round(near)) if self.quantity.whole else near

    def as_value(self, value: float | None) -> dict[str, object]:
        """Return it for JSON; None: the quantity is not known."""
        return {
            "name": self.name,
            "value": value,
            "min": self.low,
            "max": self.high,
            "unit": self.quantity.unit,
            "known": value is not None,
            "whole": self.quantity.whole,
            "words": list(self.quantity.words),
            "thresholds": list(self.thresholds),
        }


def sliders(guards: Mapping[str, PointGuard]) -> tuple[Slider, ...]:
    """Return a slider for each quantity, its ends beyond every threshold of a guard.

    Args:
        guards: by name.
    """
    ends: dict[Quantity, set[float]] = {}
    for guard in guards.values():
        for boxes in _every(guard.truth):
            for quantity, interval in _spans(boxes):
                ends.setdefault(quantity, set()).update(_finite(interval))
    return tuple(_slider(quantity, sorted(found)) for quantity, found in ends.items())


def _every(truth: GuardRegion) -> tuple[Boxes, ...]:
    return (truth.may, truth.surely, truth.may_not, truth.surely_not)


def _spans(boxes: Boxes) -> Iterator[tuple[Quantity, Interval | None]]:
    for box in boxes:
        yield from box.items()


def _finite(interval: Interval | None) -> Iterator[float]:
    if interval is not None:
        yield from (end for end in (interval.low, interval.high) if abs(end) < FAR)


def _slider(quantity: Quantity, thresholds: list[float]) -> Slider:
    low = quantity.least if abs(quantity.least) < FAR else None
    high = quantity.most if abs(quantity.most) < FAR else None
    first, last = (thresholds[0], thresholds[-1]) if thresholds else (0.0, 1.0)
    room = max(last - first, 0.5 * abs(last), 1e-3 if last else 1.0)
    inner = [it for it in thresholds if it not in {low, high}]
    return Slider(
        quantity,
        first - room if low is None else low,
        last + room if high is None else high,
        tuple(inner),
    )


def threshold_of(guard: PointGuard, value: float | None) -> float | None:
    """Return the threshold of a guard that compares one quantity: the nearest to its value.

    Args:
        guard: as the chart has it.
        value: of the quantity.
    """
    if guard.measured is None or value is None:
        return None
    spans = [span for box in guard.truth.surely for span in box.values() if span is not None]
    ends = [end for span in spans for end in _finite(span)]
    ends = [end for end in ends if end not in {guard.measured.least, guard.measured.most}] or ends
    return min(ends, key=lambda end: abs(end - value), default=None)


def candidates(slider: Slider) -> list[float]:
    """Return a value between each two thresholds of a quantity, and both ends."""
    marks = [slider.low, *slider.thresholds, slider.high]
    between = [slider.value(0.5 * (a + b)) for a, b in pairwise(marks)]
    return [it for it in dict.fromkeys((slider.low, slider.high, *between)) if math.isfinite(it)]
