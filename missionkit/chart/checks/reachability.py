"""States that are never reached, and flying states that are never left."""

from __future__ import annotations

from collections.abc import Iterator

from missionkit.chart.checks.exploration.exploration_result import Exploration
from missionkit.chart.checks.guard_regions import is_endless
from missionkit.chart.checks.guarded_transitions import AnalysedChart, GuardedTransition
from missionkit.chart.checks.interval_boxes import covered
from missionkit.chart.checks.permanent_losses import FOR_EVER
from missionkit.errors import Level, Problem
from missionkit.guards.battery import CHARGE
from missionkit.guards.state_progress import DONE_QUANTITY, TIME_IN_STATE
from missionkit.messages.region import ONLY_FALSE, Box


def unreachable(chart: AnalysedChart, explored: Exploration) -> Iterator[Problem]:
    """Yield every state that nothing leads to, the outermost of several."""
    reached = reachable(chart)
    if explored.complete:
        home = (chart.tree.of_kind("return"), chart.tree.of_kind("land"))
        pilot = [name for to in home if to for name in chart.tree.entered(to)]
        reached &= explored.reached.keys() | set(pilot)
    tree = chart.tree
    for name, (_, state, parent) in tree.states.items():
        place = tree.place(name)
        history = state.history is not None
        if name in reached or history or not place.file or (parent and parent not in reached):
            continue
        yield Problem(
            place,
            f"state {name!r} can never be reached: {_no_way(chart, name, reached)}",
            Level.WARNING,
            "unreachable-state",
            "add a transition that leads to it, or remove it",
        )


def _no_way(chart: AnalysedChart, name: str, reached: set[str]) -> str:
    for source, ways in chart.ways.items():
        for way in ways:
            if name not in way.model.targets:
                continue
            if source not in reached:
                return f"only {source!r} leads to it, which cannot be reached either"
            never = "hold" if not way.may else "fire"
            return f"{way.reason} in {source!r}, which leads to it, can never {never}"
    return "no transition, failsafe or invariant leads to it"


def reachable(chart: AnalysedChart) -> set[str]:
    """Return every state that something can lead to."""
    tree = chart.tree
    reached: set[str] = set()
    waiting = list(chart.mission.initial.to)
    waiting += [to for to in (tree.of_kind("return"), tree.of_kind("land")) if to]  # the pilot
    while waiting:
        for name in tree.entered(waiting.pop()) - reached:
            reached.add(name)
            waiting += _following(chart, name)
    return reached


def _following(chart: AnalysedChart, name: str) -> Iterator[str]:
    for way in chart.ways[name]:
        if way.may:
            yield from way.model.targets
    yield from leads_away(chart, name)


def leads_away(chart: AnalysedChart, name: str) -> Iterator[str]:
    """Yield where invariants, failsafes and broken requirements lead from a state."""
    escape = chart.tree.escape(name)
    if escape is not None:
        yield escape
    if chart.tree.flying(name):
        yield from (failsafe.model.to for failsafe in chart.failsafes if failsafe.may)
        broken = (requirement.broken for requirement in chart.mission.requirements)
        yield from (each.to for each in broken if each is not None)


def traps(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield every flying state without a way out, or without one that is ever sure to be taken."""
    tree = chart.tree
    for name in tree.leaves:
        state, place = tree.states[name].state, tree.place(name)
        around = (name, *tree.around(name))
        stays = any(tree.states[each].state.stays for each in around)
        ends = state.final or "land" in {tree.states[each].state.kind for each in around}
        if not tree.flying(name) or stays or ends or not place.file:
            continue
        exits = _exits(chart, name)
        if not exits:
            yield Problem(
                place,
                f"state {name!r} flies and has no way out but failsafes: once there, the vehicle "
                "stays until something goes wrong",
                Level.ERROR,
                "trap",
                "add a transition such as {to: ..., after: 60}, or set 'stays: true' if that is "
                "intended",
            )
        elif not _ends_some_time(chart, name, exits):
            yield Problem(
                place,
                f"state {name!r} may be flown forever: {exits[0].label} may never hold, and "
                "neither time nor an empty battery leads out",
                Level.ERROR,
                "stays-for-ever",
                "add a transition with 'after', or a failsafe with 'battery_below', or set "
                "'stays: true' if that is intended",
            )


def _exits(chart: AnalysedChart, name: str) -> list[GuardedTransition]:
    """Return the ways that leave a state, those that others take it along included."""
    tree = chart.tree
    ways = list(chart.out_of(name))
    outermost = [each for each in tree.around(name) if tree.states[each].state.parallel]
    if outermost:
        around = outermost[-1]
        ways += [
            way
            for other, inside in chart.ways.items()
            if around in tree.around(other)
            for way in inside
            if any(around not in tree.around(to) for to in way.model.targets)
        ]
    return [way for way in ways if way.may and _leaves(way, name) and _counts(way)]


def _leaves(way: GuardedTransition, name: str) -> bool:
    return any(to != name for to in way.model.targets)


def _counts(way: GuardedTransition) -> bool:
    """Say whether a way is an exit and not a failsafe of its kind of state, but for a timer."""
    return way.written or _surely_some_time(way, {TIME_IN_STATE: FOR_EVER})


def _surely_some_time(way: GuardedTransition, situation: Box) -> bool:
    late = {**situation, way.clock: FOR_EVER}
    return way.eventless and covered((late,), way.surely)


def _ends_some_time(chart: AnalysedChart, name: str, exits: list[GuardedTransition]) -> bool:
    empty: Box = {TIME_IN_STATE: FOR_EVER, CHARGE: ONLY_FALSE}
    if any(covered(({CHARGE: ONLY_FALSE},), failsafe.surely) for failsafe in chart.failsafes):
        return True
    behavior = chart.tree.states[name].state.behavior
    finishes = behavior is not None and not is_endless(behavior.plugin)
    ways = [*exits, *(way for way in chart.out_of(name) if not way.written)]
    return any(
        _surely_some_time(way, empty)
        or (finishes and _reads(way, DONE_QUANTITY))
        or _inner_end(way)
        for way in ways
    )


def _reads(way: GuardedTransition, quantity: object) -> bool:
    return way.eventless and any(quantity in box for box in way.truth.may)


def _inner_end(way: GuardedTransition) -> bool:
    """Say whether a way waits for the states inside its source to be done."""
    return any(quantity.name == f"{way.source} done" for box in way.may for quantity in box)
