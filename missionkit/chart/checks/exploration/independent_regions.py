"""Parallel regions that have nothing to do with each other: each is explored without the others.

What a region can do is then what it can do in a chart without the others: none of them takes the
chart out of the parallel state, raises an event that is heard outside itself, sets a variable that
is read outside itself, or is asked for by a guard outside itself.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.actions import Act, Assign, Cancel, Raise
from missionkit.chart.model.nearest_state import OWN_EVENTS
from missionkit.chart.model.state_definitions import State
from missionkit.chart.semantics.actions_and_events import matches
from missionkit.chart.semantics.configuration import SAFETY
from missionkit.guards.state_progress import Done, Elapsed
from missionkit.plugin_protocols import CompositeGuardProtocol

FEWEST = 2  # regions


class Traits(NamedTuple):
    """What a part of a chart does and reads."""

    states: frozenset[str]
    heard: frozenset[str]
    raised: frozenset[str]  # and cancelled
    read: frozenset[str]  # variables
    written: frozenset[str]  # variables
    asked: frozenset[str]  # states that guards ask for
    of_entry: bool  # a guard depends on when the state that commands was entered
    commands: bool  # a state has a behaviour


def independent(chart: ExploredChart) -> tuple[str, tuple[str, ...]] | None:
    """Return a parallel state and its regions if these are independent, None if none is found."""
    mission, tree = chart.analysed.mission, chart.tree
    if mission.requirements or chart.off_ground.watched:
        return None
    if any(state.history is not None for _, state, _ in tree.states.values()):
        return None
    for name, state, _ in tree.states.values():
        if state.parallel and len(state.states) >= FEWEST and _apart(chart, state):
            return name, tuple(state.states)
    return None


def _apart(chart: ExploredChart, state: State) -> bool:
    tree = chart.tree
    regions = [
        [each for each in tree.states if each == region or region in tree.around(each)]
        for region in state.states
    ]
    inside = {each for region in regions for each in region}
    parts = [_traits(chart, region) for region in regions]
    outside = _traits(chart, [each for each in tree.states if each not in inside], rest=True)
    closed = all(_closed(chart, region) for region in regions)
    if not closed or any(map(_of_engine, (*outside.heard, *(w for it in parts for w in it.heard)))):
        return False
    if outside.of_entry or any(part.of_entry and not part.commands for part in parts):
        return False
    others = {id(part): [it for it in (*parts, outside) if it is not part] for part in parts}
    return all(not _touches(part, other) for part in parts for other in others[id(part)]) and not (
        outside.asked & inside
    )


def _of_engine(word: str) -> bool:
    return word == "*" or word.startswith(OWN_EVENTS)


def _touches(one: Traits, other: Traits) -> bool:
    """Say whether what one part does matters to another."""
    heard = tuple(word.removesuffix("*").removesuffix(".") for word in other.heard)
    if any(matches(heard, event) for event in one.raised):
        return True
    if not one.raised.isdisjoint(other.raised) or not one.states.isdisjoint(other.asked):
        return True
    return not one.written.isdisjoint(other.read | other.written)


def _closed(chart: ExploredChart, region: list[str]) -> bool:
    """Say whether nothing in a region leads out of it, whatever happens in it."""
    top, inner = region[0], frozenset(region[1:])
    for name in region:
        state, compiled = chart.tree.states[name].state, chart.chart.states[name]
        if compiled.violated_to is not None or SAFETY.get(state.kind, 0) or state.parallel:
            return False
        ways = compiled.transitions
        if any(way.to and (name == top or not inner.issuperset(way.to)) for way in ways):
            return False
    return True


def _traits(chart: ExploredChart, names: list[str], *, rest: bool = False) -> Traits:
    """Return what some states do and read, with the failsafes if they are all the rest."""
    mission, tree = chart.analysed.mission, chart.tree
    states = [tree.states[name].state for name in names]
    guards = [way.when for state in states for way in state.transitions if way.when is not None]
    guards += [it.invariant.holds for it in states if it.invariant.holds is not None]
    acts = [act for state in states for act in _acts(state)]
    if rest:
        guards += [each.when for each in mission.failsafes]
        acts += [act for each in mission.failsafes for act in each.do] + list(mission.initial.do)
    parts = list(ex.opened(guards, mission.guards))
    return Traits(
        frozenset(names),
        frozenset(word for it in states for way in it.transitions for word in way.event or ()),
        frozenset(str(act.event) for act in acts if isinstance(act, Raise))
        | frozenset(str(act.event) for act in acts if isinstance(act, Cancel)),
        frozenset(part.name for part in parts if isinstance(part, ex.VariableGuard))
        | frozenset(_read_by(acts)),
        frozenset(act.variable for act in acts if isinstance(act, Assign)),
        frozenset(part.state for part in parts if isinstance(part, ex.In)),
        any(_of_entry(chart, part) for part in parts),
        any(state.behavior is not None for state in states),
    )


def _acts(state: State) -> Iterator[Act]:
    yield from (*state.entry, *state.exit)
    for way in state.transitions:
        yield from way.do
    for start in (state.initial, state.default):
        yield from () if start is None else start.do


def _read_by(acts: Iterable[Act]) -> Iterator[str]:
    for act in acts:
        if isinstance(act, Raise) and isinstance(act.after, str):
            yield act.after
        if isinstance(act, Assign):
            yield from (act.variable, str(act.operand))


def _of_entry(chart: ExploredChart, part: ex.Expression) -> bool:
    if not isinstance(part, ex.Use | ex.Hysteresis):
        return isinstance(part, ex.Finished)
    if isinstance(part, ex.Use) and isinstance(
        part.plugin, Done | Elapsed | CompositeGuardProtocol
    ):
        return True
    truth = chart.analysed.reader.truth(part)
    boxes = (*truth.may, *truth.may_not)
    return any(quantity.at_entry != "kept" for box in boxes for quantity in box)
