"""Transitions that the exploration of the chart never takes, and why."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from missionkit.chart.checks.exploration.exploration_result import Exploration, Node
from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.checks.guarded_transitions import GuardedTransition
from missionkit.chart.checks.interval_boxes import covered
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.semantics.actions_and_events import matches
from missionkit.errors import Level, Place, Problem
from missionkit.guards.state_progress import TIME_IN_STATE

STATES_SHOWN = 4  # states in a message
VALUES_SHOWN = 4  # values of a variable in a message


def problems_of(
    chart: ExploredChart, explored: Exploration, reported: Collection[Place]
) -> Iterator[Problem]:
    """Yield every transition of a state that can be reached, but that never fires.

    Args:
        chart: that was explored.
        explored: what it can do.
        reported: places of transitions that are known to be wrong already.
    """
    yield from _after_the_end(chart, reported)
    if not explored.complete:
        return
    restless = {chart.ways[number].source for each in explored.circles for number in each.taken}
    for number, way in chart.ways.items():
        if number in explored.taken or not way.written or way.source not in explored.reached:
            continue
        if way.source in restless or {
            way.place,
            way.model.place("when"),
            way.model.place("after"),
        } & set(reported):
            continue
        yield Problem(
            way.place,
            f"state {way.source!r}: {way.label} can never fire: {_why(chart, explored, way)}",
            Level.ERROR,
            "never-fires",
            "change what leads out before it, or remove it",
        )


def _after_the_end(chart: ExploredChart, reported: Collection[Place]) -> Iterator[Problem]:
    """Yield every timer that is longer than the whole mission may last."""
    limit = chart.analysed.mission.settings.time_limit
    for way in chart.ways.values():
        after = way.model.after or 0.0
        if way.written and after >= limit and way.place not in reported:
            yield Problem(
                way.model.place("after"),
                f"state {way.source!r}: {way.label} can never fire: the mission lands at its time "
                f"limit of {limit:g} s",
                Level.WARNING,
                "beyond-time-limit",
                f"make it less than {limit:g} s, or raise 'settings: {{time_limit}}'",
            )


def _why(chart: ExploredChart, explored: Exploration, way: GuardedTransition) -> str:
    here = [node for node in explored.nodes if way.source in node.memory.active]
    waits = max(way.dwell, way.model.after or 0.0)
    ages = [node.ages[way.source].low for node in here if way.source in node.ages]
    if ages and max(ages) < waits:
        return _left_before(chart, explored, way, waits)
    return _never_so(chart, way, here) or _before(chart, way)


def _never_so(chart: ExploredChart, way: GuardedTransition, here: Sequence[Node]) -> str:
    """Return which part of a guard never holds in any node where its source is active."""
    for name in _variables(chart, way):
        values = sorted({node.memory.variables[name] for node in here}, key=str)
        if values and len(values) <= VALUES_SHOWN:
            listed = " or ".join(map(str, values))
            return f"{name} is only ever {listed} in {way.source!r}"
        if values:
            return f"{name} never has such a value in {way.source!r}"
    others = [part.state for part in _parts(chart, way) if isinstance(part, ex.In)]
    for other in others:
        if not any(other in node.memory.active for node in here):
            return f"{other!r} is never active together with {way.source!r}"
    return ""


def _before(chart: ExploredChart, way: GuardedTransition) -> str:
    """Return what is taken before a transition that may be ready."""
    for failsafe in chart.analysed.failsafes:
        if failsafe.surely and covered(way.truth.may, failsafe.surely):
            return f"failsafe {failsafe.model.name!r} acts before"
    for name in (way.source, *chart.tree.around(way.source)):
        invariant = chart.tree.states[name].state.invariant
        if invariant.holds is None or invariant.exit is None:
            continue
        if covered(way.truth.may, chart.analysed.reader.truth(invariant.holds, name).surely_not):
            return f"it breaks the invariant of {name!r}, which leads to {invariant.exit!r} before"
    inside = _shadows_inside(chart, way)
    if inside:
        return f"every state inside {way.source!r} is left before: {'; '.join(inside)}"
    if way.model.event is not None:
        return "when that event can come, something before it is taken"
    return "whenever it is ready, something before it is taken"


def _shadows_inside(chart: ExploredChart, way: GuardedTransition) -> list[str]:
    """Return what goes before a transition in each state inside its source; none if not in all."""
    tree = chart.tree
    leaves = [leaf for leaf in tree.leaves if way.source in tree.around(leaf)]
    found = []
    for leaf in leaves[:STATES_SHOWN] if len(leaves) <= STATES_SHOWN else []:
        inner = (each for each in chart.analysed.out_of(leaf) if each.source != way.source)
        first = next((each for each in inner if _goes_before(each, way)), None)
        if first is None:
            return []
        found.append(f"{leaf!r} by {first.label}")
    return found


def _goes_before(one: GuardedTransition, way: GuardedTransition) -> bool:
    """Say whether a transition of an inner state is ready whenever another is, after its dwell."""
    heard = way.model.event is not None and one.model.event is not None
    if heard and not all(matches(one.model.event or (), event) for event in way.model.event or ()):
        return False
    if one.model.event is not None and way.model.event is None:
        return False
    return covered(way.truth.may, one.truth.surely)


def _left_before(
    chart: ExploredChart, explored: Exploration, way: GuardedTransition, waits: float
) -> str:
    ends = explored.left.get(way.source, {})
    own = {number: age for number, age in ends.items() if number in chart.ways}
    if not own:
        return f"{way.source!r} never lasts {waits:g} s"
    number = max(own, key=lambda each: (own[each], _by_time(chart.ways[each])))
    by = chart.ways[number]
    if not by.written:
        kind = chart.tree.states[by.source].state.kind
        what = f"{by.label}, the default failsafe {by.model.name!r} of kind {kind!r},"
        return f"it needs {waits:g} s, but {what} ends {by.source!r} after {own[number]:g} s"
    if by.source != way.source:
        return f"it needs {waits:g} s, but {by.label} ends {by.source!r} around it before"
    return f"it needs {waits:g} s, but {by.label} ends {way.source!r} after {own[number]:g} s"


def _by_time(way: GuardedTransition) -> bool:
    """Say whether a transition waits for a time in its source."""
    timed = any(TIME_IN_STATE in box for box in way.truth.may)
    return timed or way.model.after is not None


def _variables(chart: ExploredChart, way: GuardedTransition) -> list[str]:
    return [part.name for part in _parts(chart, way) if isinstance(part, ex.VariableGuard)]


def _parts(chart: ExploredChart, way: GuardedTransition) -> Iterator[ex.Expression]:
    """Return every guard inside that of a transition, named ones looked into once."""
    guards = [] if way.model.when is None else [way.model.when]
    return ex.opened(guards, chart.analysed.mission.guards)
