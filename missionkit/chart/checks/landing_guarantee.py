"""Checks that every flying state leads to land or return, whatever is lost, and how soon.

For each danger the chart is played against an opponent who chooses every guard that the danger
leaves open, from the moment when nothing fresh is left of what is lost. A state is safe if some
failsafe or timer is sure to act and all that may come before it is safe too. The bound is the
longest way through.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from heapq import heapify, heappop, heappush
from typing import NamedTuple

from missionkit.chart.checks.danger_options import (
    Option,
    Out,
    is_landing,
    is_safe,
    options_in,
    sees,
    sure_failsafes,
    to_leaves,
)
from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.checks.permanent_losses import Loss, losses
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_contracts import fulfilled
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.semantics.configuration import SAFETY
from missionkit.errors import Level, Problem

BY_POSITION = ("go_to", "ddp_go_to", "follow_path")  # behaviours that need to know where it is
STATES_SHOWN = 5  # states in a message


class Escape(NamedTuple):
    """Way out of one state in one danger."""

    danger: str
    state: str
    first: str  # what acts first
    seconds: float | None  # at most, until land or return; None: never, or unknown


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
        options = options_in(chart, danger, list(home))
        for name in chart.tree.states:
            if chart.tree.safe(name) == SAFETY["return"]:
                options[name] = _from_return(chart, danger, name)
        landed = _bounds(options, [name for name in chart.tree.states if is_landing(chart, name)])
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
    failsafes = (out for out in sure_failsafes(chart, danger) if is_landing(chart, out.to))
    inner = (way for each in _inside(chart, name) for way in chart.ways[each])
    ways = [way for way in (*inner, *chart.out_of(name)) if way.written and way.may]
    outs = [tuple(Out(to, 0.0, way.label) for to in way.model.targets) for way in ways]
    found = [to_leaves(chart, each) for each in outs if each]
    return [*((out,) for out in failsafes), *found]


def _inside(chart: AnalysedChart, name: str) -> Iterator[str]:
    yield from (each for each in chart.tree.states if name in chart.tree.around(each))


def _by_position(chart: AnalysedChart, name: str) -> bool:
    behavior = chart.tree.states[name].state.behavior
    return behavior is not None and behavior.kind in BY_POSITION


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
    options = options_in(chart, danger, concerned)
    bounds = _bounds(options, [name for name in chart.tree.states if is_safe(chart, name)])
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


def _concerns(chart: AnalysedChart, name: str, danger: Loss) -> bool:
    tree = chart.tree
    state = tree.states[name].state
    if not tree.flying(name) or state.final or is_safe(chart, name):
        return False
    if danger.name != "camera":
        return True
    return any(sees(chart, each) for each in (name, *tree.around(name)))
