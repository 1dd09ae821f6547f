"""Transitions into a state, and actions and guards that use a variable."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.actions import Act, Assign
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.placed_states import Placed
from missionkit.chart.model.state_definitions import Start, Transition
from missionkit.chart.prose.phrases import action, listed

BY_FAILSAFE = "by the failsafe"
Clauses = Mapping[str, Sequence[str]]  # name of a state or variable -> clauses


def entrances(mission: Mission) -> Clauses:
    """Return for each state what leads into it: "from gps and visual", "by the failsafe link"."""
    found: defaultdict[str, defaultdict[str, dict[str, None]]] = defaultdict(
        lambda: defaultdict(dict)
    )
    for to, how, name in _entrances(mission):
        found[to][how][name] = None
    return {
        to: [_led(how, list(names)) for how, names in ways.items()] for to, ways in found.items()
    }


def _led(how: str, names: Sequence[str]) -> str:
    plural = "s" if how == BY_FAILSAFE and len(names) > 1 else ""
    return f"{how}{plural} {listed(names)}".rstrip()


def _entrances(mission: Mission) -> Iterator[tuple[str, str, str]]:
    """Yield a state, how it is entered, and what leads there."""
    yield from ((to, "at the very beginning", "") for to in mission.initial.to)
    for name, state, _ in mission.walk():
        if state.initial is not None:
            yield from ((to, "at the beginning of", name) for to in state.initial.to)
        if state.parallel:
            yield from ((inner, "with", name) for inner in state.states)
        if state.default is not None:
            yield from ((to, "by the history", name) for to in state.default.to)
        for way in state.transitions:
            yield from ((to, "from", name) for to in way.targets)
        if state.invariant.exit is not None:
            yield state.invariant.exit, "by the broken invariant of", name
    yield from _last_resorts(mission)


def _last_resorts(mission: Mission) -> Iterator[tuple[str, str, str]]:
    for failsafe in mission.failsafes:
        yield failsafe.to, BY_FAILSAFE, failsafe.name
    yield from (
        (each.broken.to, "by the broken requirement", each.name)
        for each in mission.requirements
        if each.broken is not None
    )


def changes(mission: Mission) -> Clauses:
    """Return for each variable the actions that change it, and when."""
    return _gathered(
        (act.variable, f"{when} the chart {action(act)}")
        for when, acts in _actions(mission)
        for act in acts
        if isinstance(act, Assign)
    )


def _actions(mission: Mission) -> Iterator[tuple[str, Iterable[Act]]]:
    yield "at the beginning", mission.initial.do
    for failsafe in mission.failsafes:
        yield f"by the failsafe {failsafe.name}", failsafe.do
    for placed in mission.walk():
        yield from _actions_of(placed)


def _actions_of(placed: Placed) -> Iterator[tuple[str, Iterable[Act]]]:
    name, state, _ = placed
    yield f"on entry to {name}", state.entry
    yield f"on exit from {name}", state.exit
    yield from ((f"on the way {path(name, way)}", way.do) for way in state.transitions)
    starts: list[Start | None] = [state.initial, state.default]
    yield from ((f"when {name} begins", start.do) for start in starts if start is not None)


def path(name: str, way: Transition) -> str:
    """Name a transition: "from gps to visual", "in gps"."""
    return f"from {name} to {' and '.join(way.targets)}" if way.targets else f"inside {name}"


def readers(mission: Mission) -> Clauses:
    """Return for each variable what compares it."""
    every = (*_guards(mission), *_required(mission))
    return _gathered((name, who) for who, guard in every for name in _variables(guard))


def _variables(guard: ex.Expression) -> Iterator[str]:
    yield from (part.name for part in ex.parts_of(guard) if isinstance(part, ex.VariableGuard))
    yield from (name for name, _ in ex.variables_in(guard))


def _guards(mission: Mission) -> Iterator[tuple[str, ex.Expression]]:
    for name, guard in mission.guards.items():
        yield f"the guard {name}", guard
    for failsafe in mission.failsafes:
        yield f"the failsafe {failsafe.name}", failsafe.when
    for name, state, _ in mission.walk():
        for way in state.transitions:
            if way.when is not None:
                yield f"the transition {path(name, way)}", way.when
        if state.invariant.holds is not None:
            yield f"the invariant of {name}", state.invariant.holds


def _required(mission: Mission) -> Iterator[tuple[str, ex.Expression]]:
    for requirement in mission.requirements:
        yield from ((f"the requirement {requirement.name}", it) for it in requirement.guards())


def _gathered(pairs: Iterable[tuple[str, str]]) -> Clauses:
    """Gather the clauses of each name, each clause once."""
    found: defaultdict[str, dict[str, None]] = defaultdict(dict)
    for name, clause in pairs:
        found[name][clause] = None
    return {name: list(clauses) for name, clauses in found.items()}
