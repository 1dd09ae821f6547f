"""Checks that every flying state leads to land or return, whatever is lost, and how soon.

For each danger the chart is played against an opponent who chooses every guard that the danger
leaves open, from the moment when nothing fresh is left of what is lost. A state is safe if some
failsafe or timer is sure to act and all that may come before it is safe too. The bound is the
longest way through.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from heapq import heapify, heappop, heappush
from typing import NamedTuple

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.checks.interval_boxes import covered, intersection
from missionkit.chart.checks.permanent_losses import FOR_EVER, Loss, losses
from missionkit.chart.checks.plugin_requirements import SEEING
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_contracts import fulfilled
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.semantics.chart_compiler import (
    PLUGIN_FAILURE_TOLERANCE,
    STUCK_FOR_GOOD,
)
from missionkit.chart.semantics.configuration import SAFETY
from missionkit.errors import Level, Problem
from missionkit.guards.converged import ON_TARGET
from missionkit.guards.state_progress import TIME_IN_STATE
from missionkit.messages.region import ONLY_TRUE, Box, Boxes, Quantity

BY_POSITION = ("go_to", "ddp_go_to", "follow_path")  # behaviours that need to know where it is
STATES_SHOWN = 5  # states in a message


class Escape(NamedTuple):
    """Way out of one state in one danger."""

    danger: str
    state: str
    first: str  # what acts first
    seconds: float | None  # at most, until land or return; None: never, or unknown


class Out(NamedTuple):
    """One way out: where to, how soon, and by what."""

    to: str
    seconds: float
    by: str  # of what is sure, which comes first


Option = tuple[Out, ...]


def escapes(mission: Mission, catalogue: Catalogue) -> tuple[Escape, ...]:
    """Return for each danger and each flying state how soon it comes to land or return."""
    catalogue = catalogue.flying(mission.vehicle.use)
    chart = AnalysedChart(fulfilled(mission, catalogue), catalogue)
    return tuple(escape for danger in losses(chart) for escape in _played(chart, danger))


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield a warning for each danger in which some flying state has no sure way home."""
    mission = chart.mission
    place = mission.place("failsafes" if mission.failsafes else "states")
    for danger in losses(chart):
        stuck = [escape for escape in _played(chart, danger) if escape.seconds is None]
        stuck = [escape for escape in stuck if chart.tree.place(escape.state).file]
        if not stuck:
            continue
        named = ", ".join(repr(escape.state) for escape in stuck[:STATES_SHOWN])
        more = f" and {len(stuck) - STATES_SHOWN} more" if len(stuck) > STATES_SHOWN else ""
        yield Problem(
            place,
            f"{danger.says}: no failsafe or timer is guaranteed to lead from {named}{more} to a "
            f"state of kind land or return; {_because(chart, danger, stuck[0])}",
            Level.WARNING,
            f"unsafe-{danger.name}",
            danger.remedy,
        )


def returns(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield a problem for each danger that leads to a state of kind return that never lands.

    On the way home the danger stays: a return that leads back to the mission comes home again, and
    one that flies by the position is of no use when that is lost. It is an error if a failsafe
    leads there; if no failsafe acts at all, a warning.
    """
    for danger in losses(chart):
        home = {
            escape.state: escape for escape in _played(chart, danger) if escape.seconds is not None
        }
        options = _options(chart, danger, list(home))
        for name in chart.tree.states:
            if chart.tree.safe(name) == SAFETY["return"]:
                options[name] = _from_return(chart, danger, name)
        landed = _bounds(options, [name for name in chart.tree.states if _lands(chart, name)])
        lost = [name for name in home if name not in landed and chart.tree.place(name).file]
        if lost:
            yield _never_lands(chart, danger, lost, home[lost[0]], options)


def _never_lands(
    chart: AnalysedChart,
    danger: Loss,
    lost: Sequence[str],
    escape: Escape,
    options: Mapping[str, Sequence[Option]],
) -> Problem:
    named = ", ".join(repr(name) for name in lost[:STATES_SHOWN])
    ahead = [out.to for option in options[escape.state] for out in option]
    to = next((name for name in ahead if chart.tree.safe(name) == SAFETY["return"]), ahead[0])
    by_position = danger.name == "position" and _by_position(chart, to)
    why = "flies by the position" if by_position else "does not come to land"
    remedy = f"lead from {to!r} to land when done"
    by_failsafe = escape.first.startswith("failsafe ")
    first = escape.first or "what acts"
    leads = f"{first} leads to {to!r}, which" if by_failsafe else f"{first} is taken, but {to!r}"
    if by_position:
        remedy = "let it lead to the state of kind land" if by_failsafe else danger.remedy
    mission = chart.mission
    return Problem(
        mission.place("failsafes" if mission.failsafes else "states"),
        f"{danger.says}: in {named} {leads} {why}",
        Level.ERROR if by_failsafe or not by_position else Level.WARNING,
        f"unsafe-{danger.name}",
        remedy,
    )


def _from_return(chart: AnalysedChart, danger: Loss, name: str) -> list[Option]:
    """Return the ways on from a state of kind return; its behaviour is taken to finish."""
    if danger.name == "position" and _by_position(chart, name):
        return []
    failsafes = (out for out in _failsafes(chart, danger) if _lands(chart, out.to))
    inner = (way for each in _inside(chart, name) for way in chart.ways[each])
    ways = [way for way in (*inner, *chart.out_of(name)) if way.written and way.may]
    outs = [tuple(Out(to, 0.0, way.label) for to in way.model.targets) for way in ways]
    found = [_to_leaves(chart, each) for each in outs if each]
    return [*((out,) for out in failsafes), *found]


def _inside(chart: AnalysedChart, name: str) -> Iterator[str]:
    yield from (each for each in chart.tree.states if name in chart.tree.around(each))


def _by_position(chart: AnalysedChart, name: str) -> bool:
    behavior = chart.tree.states[name].state.behavior
    return behavior is not None and behavior.kind in BY_POSITION


def _lands(chart: AnalysedChart, name: str) -> bool:
    around = (name, *chart.tree.around(name))
    return any(chart.tree.safe(each) == SAFETY["land"] for each in around)


def _because(chart: AnalysedChart, danger: Loss, escape: Escape) -> str:
    where = f"in {escape.state!r}"
    if escape.first:
        return f"{where} {escape.first} acts, but from there the flight may never end"
    for failsafe in chart.failsafes:
        read = {quantity for box in failsafe.surely for quantity in box}
        if read & danger.box.keys() and failsafe.model.to != escape.state:
            return f"{where} failsafe {failsafe.model.name!r} needs more than that to act"
    return f"{where} nothing acts then"


def _played(chart: AnalysedChart, danger: Loss) -> list[Escape]:
    """Return what becomes of each flying state in a danger."""
    concerned = [name for name in chart.tree.leaves if _concerns(chart, name, danger)]
    options = _options(chart, danger, concerned)
    bounds = _bounds(options, [name for name in chart.tree.states if _safe(chart, name)])
    return [
        Escape(danger.name, name, options[name][0][0].by if options[name] else "", bounds.get(name))
        for name in concerned
    ]


def _bounds(options: Mapping[str, Sequence[Option]], safe: Iterable[str]) -> dict[str, float]:
    """Return the least bound of each state: the best option, each as bad as its worst outcome.

    Knuth's generalisation of Dijkstra's algorithm (1977): states are settled nearest first.
    """
    before: dict[str, list[tuple[str, int]]] = {}
    missing: dict[tuple[str, int], int] = {}
    for name, each in options.items():
        for number, outs in enumerate(each):
            targets = {out.to for out in outs}
            missing[name, number] = len(targets)
            for to in targets:
                before.setdefault(to, []).append((name, number))
    bounds: dict[str, float] = {}
    waiting = [(0.0, name) for name in safe]
    heapify(waiting)
    while waiting:
        seconds, settled = heappop(waiting)
        if settled in bounds:
            continue
        bounds[settled] = seconds
        for name, number in before.get(settled, ()):
            missing[name, number] -= 1
            if not missing[name, number] and name not in bounds:
                worst = max(out.seconds + bounds[out.to] for out in options[name][number])
                heappush(waiting, (worst, name))
    return bounds


def _safe(chart: AnalysedChart, name: str) -> bool:
    return any(chart.tree.safe(each) for each in (name, *chart.tree.around(name)))


def _concerns(chart: AnalysedChart, name: str, danger: Loss) -> bool:
    tree = chart.tree
    state = tree.states[name].state
    if not tree.flying(name) or state.final or _safe(chart, name):
        return False
    if danger.name != "camera":
        return True
    return any(_sees(chart, each) for each in (name, *tree.around(name)))


def _sees(chart: AnalysedChart, name: str) -> bool:
    behavior = chart.tree.states[name].state.behavior
    return behavior is not None and behavior.kind in SEEING


def _options(chart: AnalysedChart, danger: Loss, concerned: list[str]) -> dict[str, list[Option]]:
    """Return for each state what is sure to end it, with all that may come before."""
    outsiders: dict[tuple[str, float], Option] = {}
    found: dict[str, list[Option]] = {}
    failsafes = tuple(_failsafes(chart, danger))
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
        found[name] = [_to_leaves(chart, outs) for outs in options]
        ahead = {out.to for option in found[name] for out in option}
        waiting += sorted(leaf for leaf in ahead if not _safe(chart, leaf))
    return found


def _to_leaves(chart: AnalysedChart, outs: Sequence[Out]) -> Option:
    return tuple(Out(leaf, out.seconds, out.by) for out in outs for leaf in _leaves(chart, out.to))


def _leaves(chart: AnalysedChart, name: str) -> list[str]:
    """Return the flying states that are active after going to one, or all that there are."""
    tree = chart.tree
    if _safe(chart, name):
        return [name]
    inner = [leaf for leaf in sorted(tree.entered(name)) if not tree.states[leaf].state.states]
    flying = [leaf for leaf in inner if tree.flying(leaf)]
    return flying or inner or [name]


def _failsafes(chart: AnalysedChart, danger: Loss) -> Iterator[Out]:
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
        if _sees(chart, name):
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
