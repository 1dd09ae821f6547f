"""Hysteresis that contradicts the guard it is about."""

from __future__ import annotations

import math
from collections.abc import Iterator

from missionkit.chart.checks.guard_regions import region_of
from missionkit.chart.checks.guarded_transitions import AnalysedChart, shortened
from missionkit.chart.checks.interval_boxes import ALL_VALUES, within
from missionkit.chart.model import guard_expressions as ex
from missionkit.errors import Level, Problem
from missionkit.messages.region import Interval, Quantity

CODE = "contradictory-hysteresis"


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield every latch that can never begin, never end, or holds where its guard does not."""
    guards = [*chart.mission.guards.values(), *(guard for _, guard in chart.tree.guards())]
    for guard in guards:
        for part in ex.parts_of(guard):
            if isinstance(part, ex.Hysteresis):
                yield from _contrary(chart, part)


def _contrary(chart: AnalysedChart, latch: ex.Hysteresis) -> Iterator[Problem]:
    quantity = chart.reader.measured(latch.part)
    if quantity is None:
        return
    grows = latch.enter > latch.exit
    side = Interval.at_least if grows else Interval.at_most
    guard_text = shortened(ex.text(latch.part))
    if within(quantity, side(latch.enter)) is None:
        yield _problem(
            latch,
            f"{guard_text!r} is never {'at least' if grows else 'at most'} {latch.enter:g}: "
            f"{_range(quantity)}; the latch can never close",
            "use an 'enter' value that can be reached",
        )
    elif within(quantity, side(latch.exit)) == within(quantity, ALL_VALUES):
        yield _problem(
            latch,
            f"{guard_text!r} is never {'below' if grows else 'above'} {latch.exit:g}: "
            f"{_range(quantity)}; once closed, the latch never opens",
            "use an 'exit' value that can be crossed",
        )
    elif _turned(chart, latch, quantity, grows=grows):
        value = f"{latch.enter:g} {quantity.unit}".strip()
        yield _problem(
            latch,
            f"at {quantity.name} {value} the latch closes, where {guard_text!r} itself does "
            f"not: 'exit: {latch.exit:g}' is on the wrong side of 'enter: {latch.enter:g}'",
            "swap 'enter' and 'exit', or write 'not' around the latch of the opposite",
        )


def _turned(chart: AnalysedChart, latch: ex.Hysteresis, quantity: Quantity, *, grows: bool) -> bool:
    """Say whether the guard holds for small values and the latch for large ones, or the reverse."""
    part = latch.part
    while isinstance(part, ex.Named):
        part = chart.mission.guards[part.name]
    region = region_of(part.plugin) if isinstance(part, ex.Use) else None
    spans = [box.get(quantity) for box in (() if region is None else region.may)]
    if len(spans) != 1 or spans[0] is None:
        return False
    cut = within(quantity, spans[0])
    if cut is None:
        return False
    low = cut.high < quantity.most and cut.low <= quantity.least
    high = cut.low > quantity.least and cut.high >= quantity.most
    return (low and grows) or (high and not grows)


def _range(quantity: Quantity) -> str:
    if math.isinf(quantity.most):
        return f"{quantity.name} is at least {quantity.least:g}"
    return f"{quantity.name} is from {quantity.least:g} to {quantity.most:g}"


def _problem(latch: ex.Hysteresis, message: str, remedy: str) -> Problem:
    return Problem(latch.place, f"hysteresis: {message}", Level.ERROR, CODE, remedy)
