"""What leads out of a flying state in a danger: what is sure to act, and all that may come before.

The danger is played against an opponent who chooses every guard that it leaves open, from the
moment when nothing fresh is left of what is lost.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.checks.interval_boxes import covered, intersection
from missionkit.chart.checks.permanent_losses import FOR_EVER, Loss
from missionkit.chart.checks.plugin_requirements import SEEING
from missionkit.chart.semantics.chart_compiler import (
    PLUGIN_FAILURE_TOLERANCE,
    STUCK_FOR_GOOD,
)
from missionkit.chart.semantics.configuration import SAFETY
from missionkit.guards.converged import ON_TARGET
from missionkit.guards.state_progress import TIME_IN_STATE
from missionkit.messages.region import ONLY_TRUE, Box, Boxes, Quantity


class Out(NamedTuple):
    """One way out: where to, how soon, and by what."""

    to: str
    seconds: float
    by: str  # of what is sure, which comes first


Option = tuple[Out, ...]


def is_safe(chart: AnalysedChart, name: str) -> bool:
    """Say whether a state, or one around it, is of kind land or return."""
    return any(chart.tree.safe(each) for each in (name, *chart.tree.around(name)))


def is_landing(chart: AnalysedChart, name: str) -> bool:
    """Say whether a state, or one around it, is of kind land."""
    around = (name, *chart.tree.around(name))
    return any(chart.tree.safe(each) == SAFETY["land"] for each in around)


def sees(chart: AnalysedChart, name: str) -> bool:
    """Say whether a state's behaviour works by what the camera sees."""
    behavior = chart.tree.states[name].state.behavior
    return behavior is not None and behavior.kind in SEEING


def options_in(chart: AnalysedChart, danger: Loss, concerned: list[str]) -> dict[str, list[Option]]:
    """Return for each state what is sure to end it, with all that may come before.

    Args:
        chart: analysed.
        danger: that stays.
        concerned: states to begin with.
    """
    outsiders: dict[tuple[str, float], Option] = {}
    found: dict[str, list[Option]] = {}
    failsafes = tuple(sure_failsafes(chart, danger))
    waiting = list(concerned)
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        options = [[out] for out in failsafes if out.to != name]
        if any(chart.tree.safe(out.to) for (out,) in options):
            found[name] = [(out,) for (out,) in options if chart.tree.safe(out.to)]
            continue
        for source, sure in _sure(chart, name, danger.box).items():
            options.append([*sure, *_before(chart, name, source, danger.box, sure, outsiders)])
        found[name] = [to_leaves(chart, outs) for outs in options]
        ahead = {out.to for option in found[name] for out in option}
        waiting += sorted(leaf for leaf in ahead if not is_safe(chart, leaf))
    return found


def to_leaves(chart: AnalysedChart, outs: Sequence[Out]) -> Option:
    """Return ways out with the flying states in place of those around them."""
    return tuple(Out(leaf, out.seconds, out.by) for out in outs for leaf in _leaves(chart, out.to))


def _leaves(chart: AnalysedChart, name: str) -> list[str]:
    """Return the flying states that are active after going to one, or all that there are."""
    tree = chart.tree
    if is_safe(chart, name):
        return [name]
    inner = [leaf for leaf in sorted(tree.entered(name)) if not tree.states[leaf].state.states]
    flying = [leaf for leaf in inner if tree.flying(leaf)]
    return flying or inner or [name]


def sure_failsafes(chart: AnalysedChart, danger: Loss) -> Iterator[Out]:
    """Yield what the failsafes that are sure to act in a danger lead to."""
    for failsafe in chart.failsafes:
        model = failsafe.model
        if covered((danger.box,), failsafe.surely):
            after = _threshold(failsafe.surely, danger.box)
            yield Out(model.to, after + model.for_, f"failsafe {model.name!r}")
    if danger.name == "plug-in":
        to = chart.tree.of_kind("return") or chart.tree.of_kind("land")
        if to is not None:
            yield Out(to, PLUGIN_FAILURE_TOLERANCE, "failsafe 'plug-in failed'")
        land = chart.tree.of_kind("land")
        if land is not None:
            yield Out(land, STUCK_FOR_GOOD, "failsafe 'plug-in failed'")


def _sure(chart: AnalysedChart, name: str, danger: Box) -> dict[str, list[Out]]:
    """Return the first thing that surely leaves a state, and each of those around it."""
    found: dict[str, list[Out]] = {}
    for way in chart.out_of(name):
        to = way.model.targets
        inside = any(way.source in (each, *chart.tree.around(each)) for each in to)
        if not way.eventless or not to or inside:
            continue
        situation = {**danger, way.clock: FOR_EVER, TIME_IN_STATE: FOR_EVER}
        if covered((situation,), way.surely):
            lasting = _threshold(way.truth.surely, situation) + way.model.for_
            after = max(lasting, way.soonest)
            before = found.get(way.source)
            if before is None or after < before[0].seconds:
                found[way.source] = [Out(each, after, way.label) for each in to]
    return found


def _before(
    chart: AnalysedChart,
    name: str,
    source: str,
    danger: Box,
    sure: Sequence[Out],
    outsiders: dict[tuple[str, float], Option],
) -> Option:
    """Return what may lead out of `source` before something sure does.

    What happens inside a state around does not stop that state's clock.
    """
    within = sure[0].seconds
    if source == name:
        return tuple(_may(chart, (name, *chart.tree.around(name)), name, danger, within))
    if (source, within) not in outsiders:
        inside = (each for each in chart.ways if source in (each, *chart.tree.around(each)))
        names = (*inside, *chart.tree.around(source))
        outsiders[source, within] = tuple(_may(chart, names, source, danger, within))
    return outsiders[source, within]


def _may(
    chart: AnalysedChart, names: Iterable[str], left: str, danger: Box, within: float
) -> Iterator[Out]:
    """Yield the ways of some states out of `left` that are possible within `within` seconds."""
    rising: set[Quantity] = {quantity for quantity, span in danger.items() if span == FOR_EVER}
    fixed: Box = {quantity: span for quantity, span in danger.items() if span != FOR_EVER}
    for name in names:
        if sees(chart, name):
            fixed = {**fixed, ON_TARGET: ONLY_TRUE}
        for way in chart.ways[name]:
            if way.soonest <= within and way.may:
                possible = _without(way.truth.may, rising)
                if intersection(possible, (fixed,), sure=False):
                    yield from _out(chart, left, way.model.targets, within)
        escape = chart.tree.escape(name)
        if escape is not None:
            yield from _out(chart, left, (escape,), within)


def _out(chart: AnalysedChart, left: str, targets: Sequence[str], within: float) -> Iterator[Out]:
    for to in targets:
        if left not in chart.tree.around(to):
            yield Out(to, within, "")


def _threshold(region: Boxes, danger: Box) -> float:
    """Return how long (s) after a loss a region that then surely comes is reached."""
    best = math.inf
    for box in region:
        if covered((danger,), (box,)):
            times = [span.low for quantity, span in box.items() if span and quantity.unit == "s"]
            best = min(best, max(times, default=0.0))
    return 0.0 if math.isinf(best) else max(best, 0.0)


def _without(region: Boxes, rising: set[Quantity]) -> Boxes:
    """Return a region without its conditions on rising quantities; some are too high for it."""
    return tuple(
        {quantity: span for quantity, span in box.items() if quantity not in rising}
        for box in region
        if all(span is None or span.high >= FOR_EVER.low for q, span in box.items() if q in rising)
    )
