"""Rules for the tree of states, beyond those for single states."""

from __future__ import annotations

from collections.abc import Iterator

from missionkit.chart.model.mission import Mission
from missionkit.chart.model.placed_states import Placed, around
from missionkit.chart.model.state_definitions import Start, State
from missionkit.errors import Place, Problem

Tree = dict[str, Placed]


def problems_of(mission: Mission) -> list[Problem]:
    """Return what is wrong with the tree: doubled names, states without a beginning, and so on."""
    if doubled := list(_doubled(mission)):
        return doubled
    tree = mission.by_name()
    found = list(_start(tree, mission.initial, mission.place("initial"), None))
    for placed in tree.values():
        found += _shape(placed)
        found += _inside(tree, placed)
        found += _regions(placed)
        found += _ways(tree, placed)
    found += _no_history(tree, mission)
    return found


def _doubled(mission: Mission) -> Iterator[Problem]:
    seen: dict[str, Place] = {}
    for name, state, _ in mission.walk():
        if name in seen:
            message = f"state {name!r}: the name is already used, at {seen[name]}; names of "
            yield Problem(state.place(), message + "states must be unique in the whole file")
        seen.setdefault(name, state.place())


def _shape(placed: Placed) -> Iterator[Problem]:
    """Check what a state of its shape may have, and must."""
    name, state, parent = placed
    what, banned = _banned(state)
    for key in banned:
        if key in state.model_fields_set and getattr(state, key):
            yield Problem(state.place(key), f"state {name!r}: {what} has no {key!r}")
    if state.states and not state.parallel and state.initial is None:
        yield Problem(
            state.place("states"),
            f"state {name!r}: missing key 'initial': the state inside it to begin in",
        )
    if state.parallel and not state.states:
        yield Problem(state.place("parallel"), f"state {name!r}: 'parallel' needs 'states'")
    if state.history is not None:
        if parent is None:
            message = f"state {name!r}: a history belongs to its enclosing state, and there is none"
            yield Problem(state.place("history"), message)
        elif state.default is None:
            message = f"state {name!r}: missing key 'default': where it leads the first time"
            yield Problem(state.place("history"), message)


def _banned(state: State) -> tuple[str, tuple[str, ...]]:
    if state.history is not None:
        keys = ("states", "initial", "parallel", "final", "behavior", "transitions")
        return "a history", (*keys, "entry", "exit", "stays")
    if state.final:
        return "a final state", ("states", "initial", "parallel", "transitions", "default")
    if not state.states:
        return "a state without states inside", ("initial", "default")
    return "a state with states inside", ("default", *(("initial",) if state.parallel else ()))


def _inside(tree: Tree, placed: Placed) -> Iterator[Problem]:
    name, state, parent = placed
    if state.initial is not None:
        yield from _start(tree, state.initial, state.place("initial"), name)
    if state.default is not None and parent is not None:
        yield from _start(tree, state.default, state.place("default"), parent)
        for to in state.default.to:
            if tree[to].state.history is not None:
                message = f"state {name!r}: its default {to!r} is a history; name a state"
                yield Problem(state.place("default"), message)


def _regions(placed: Placed) -> Iterator[Problem]:
    name, state, _ = placed
    if not state.parallel:
        return
    for region, inner in state.states.items():
        if inner.final:
            message = f"state {region!r}: a final state belongs inside a region of {name!r}"
            yield Problem(inner.place("final"), message)
    commanding = [region for region, inner in state.states.items() if _commands(inner)]
    if len(commanding) > 1:
        message = (
            f"state {name!r}: {' and '.join(map(repr, commanding))} are active together and each "
            "has a behaviour; only one can command"
        )
        yield Problem(state.place("parallel"), message)


def _commands(state: State) -> bool:
    return state.behavior is not None or any(map(_commands, state.states.values()))


def _start(tree: Tree, start: Start, place: Place, outer: str | None) -> Iterator[Problem]:
    """Check that a beginning leads into its own state, and to one place in each region."""
    for to in start.to:
        if outer is not None and outer not in around(tree, tree[to].parent):
            yield Problem(place, f"state {outer!r}: begins in {to!r}, which is not inside it")
    yield from _together(tree, start.to, place)


def _ways(tree: Tree, placed: Placed) -> Iterator[Problem]:
    for transition in placed.state.transitions:
        yield from _together(tree, transition.targets, transition.place("to"))


def _together(tree: Tree, names: tuple[str, ...], place: Place) -> Iterator[Problem]:
    """Check that states can be active at the same time: each in its own region."""
    for at, one in enumerate(names):
        for other in names[at + 1 :]:
            if not _orthogonal(tree, one, other):
                message = f"{one!r} and {other!r} cannot be active together: name one for each "
                yield Problem(place, message + "region of a parallel state")


def _orthogonal(tree: Tree, one: str, other: str) -> bool:
    one, other = _stood_for(tree, one), _stood_for(tree, other)
    here, there = around(tree, tree[one].parent), around(tree, tree[other].parent)
    if one == other or one in there or other in here:
        return False
    common = next((name for name in here if name in there), None)
    return common is not None and tree[common].state.parallel


def _stood_for(tree: Tree, name: str) -> str:
    """Return what a target enters for certain: a history the state that it is the history of."""
    placed = tree[name]
    return placed.parent or name if placed.state.history is not None else name


def _no_history(tree: Tree, mission: Mission) -> Iterator[Problem]:
    """Check that failsafes, invariants and requirements lead to states, whose safety is known."""
    for failsafe in mission.failsafes:
        if tree[failsafe.to].state.history is not None:
            message = f"failsafe {failsafe.name!r}: {failsafe.to!r} is a history, not a state"
            yield Problem(failsafe.place("to"), message)
    names: set[str] = set()
    for requirement in mission.requirements:
        if requirement.name in names:
            message = f"requirement {requirement.name!r}: the name is already used"
            yield Problem(requirement.place("name"), message)
        names.add(requirement.name)
        broken = requirement.broken
        if broken is not None and tree[broken.to].state.history is not None:
            message = f"requirement {requirement.name!r}: {broken.to!r} is a history, not a state"
            yield Problem(broken.place("to"), message)
    for name, state, _ in tree.values():
        to = state.invariant.exit
        if to is not None and tree[to].state.history is not None:
            message = f"state {name!r}: invariant: {to!r} is a history, not a state"
            yield Problem(state.invariant.place("exit"), message)
