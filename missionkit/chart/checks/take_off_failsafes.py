"""Failsafes that act as soon as the vehicle lifts off."""

from __future__ import annotations

import math
from collections.abc import Iterator

from missionkit.chart.checks.counterexample_text import example
from missionkit.chart.checks.guarded_transitions import AnalysedChart, Guarded
from missionkit.chart.checks.interval_boxes import covered
from missionkit.chart.checks.planned_legs import Point3
from missionkit.chart.model import guard_expressions as ex
from missionkit.errors import Level, Problem
from missionkit.guards.battery import CHARGE
from missionkit.guards.geofence import InsideFence
from missionkit.messages.region import Interval, Quantity

LIFTED = 0.3  # m, at which the vehicle is in the air whatever its range says
TAKEN = 0.002  # of the charge, on the way up
POINTS = 32  # of the climb
Spans = dict[Quantity, Interval | None]


def problems_of(chart: AnalysedChart, charge: float = 1.0) -> Iterator[Problem]:
    """Yield each failsafe whose guard surely holds at take-off, for as long as it must.

    Args:
        chart: the mission's.
        charge: of the battery at the start, 0 to 1.
    """
    begun = {name for to in chart.mission.initial.to for name in chart.tree.entered(to)}
    height = _climb(chart)
    for failsafe in chart.failsafes:
        model = failsafe.model
        top = height if model.for_ else min(LIFTED, height)
        spans = _spans(chart, charge, [(0.0, 0.0, -top * k / POINTS) for k in range(POINTS + 1)])
        if model.to not in begun and failsafe.may and covered((spans,), failsafe.surely):
            yield _problem(chart, failsafe, charge)


def _problem(chart: AnalysedChart, failsafe: Guarded, charge: float) -> Problem:
    read = {quantity for box in failsafe.surely for quantity in box}
    start = _spans(chart, charge, [(0.0, 0.0, 0.0)])
    shown = example(({quantity: span for quantity, span in start.items() if quantity in read},))
    held = f" for {failsafe.model.for_:g} s" if failsafe.model.for_ else ""
    always = f"it holds at {shown}" if shown else "it always holds"
    return Problem(
        failsafe.model.place("when"),
        f"failsafe {failsafe.model.name!r} acts at take-off: {always}{held}, so every flight goes "
        f"to {failsafe.model.to!r} at once",
        Level.ERROR,
        "acts-at-take-off",
        "choose a threshold that take-off does not violate, or make it a transition of the states "
        "that it is meant for",
    )


def _climb(chart: AnalysedChart) -> float:
    """Return the height (m) that every take-off of the mission climbs through."""
    behaviors = [state.behavior for _, state, _ in chart.tree.states.values()]
    heights = [
        float(getattr(each.plugin, "height", 0.0))
        for each in behaviors
        if each is not None and each.kind == "take_off"
    ]
    return min(heights, default=LIFTED)


def _spans(chart: AnalysedChart, charge: float, points: list[Point3]) -> Spans:
    """Return where the quantities that are known at take-off lie over some points."""
    spans: Spans = {CHARGE: Interval(charge - TAKEN, charge, high_open=True)}
    for quantity, spot in chart.reader.places.spots.items():
        far = [math.dist(spot.position, point) for point in points]
        spans[quantity] = Interval(max(0.0, min(far) - spot.off), max(far) + spot.off)
    for _, guard in chart.tree.guards():
        for fence in _fences(chart, guard):
            (quantity,) = fence.region().may[0]
            left = [fence.margin(point) for point in points]
            spans[quantity] = Interval(min(left), max(left))
    return spans


def _fences(chart: AnalysedChart, guard: ex.Expression) -> Iterator[InsideFence]:
    for part in ex.parts_of(guard):
        if isinstance(part, ex.Named):
            yield from _fences(chart, chart.mission.guards[part.name])
        elif isinstance(part, ex.Use) and isinstance(part.plugin, InsideFence):
            yield part.plugin
