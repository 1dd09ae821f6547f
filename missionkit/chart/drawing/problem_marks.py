"""Which states and transitions a drawing marks: those that problems were found with."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import PurePath

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.model_base import MissionPart
from missionkit.chart.model.state_definitions import State, Transition
from missionkit.errors import Place, Problem

Way = tuple[str, int]  # a transition: its state's name, its number in the list
Numbers = tuple[int, ...]
Owner = tuple[str | Way, list[Place]]  # a state or transition, and the places it is written at


@dataclass(frozen=True, slots=True)
class Marks:
    """The numbers of the problems with each state and each transition, and all of them in words."""

    states: Mapping[str, Numbers] = field(default_factory=dict)
    ways: Mapping[Way, Numbers] = field(default_factory=dict)
    lines: tuple[str, ...] = ()


UNMARKED = Marks()


def marks(mission: Mission, problems: Sequence[Problem]) -> Marks:
    """Return what to mark; problems that belong to no state are only listed.

    Of a file that is included several times, the instance that has the problem is marked, or all
    of them where all have it.
    """
    instances: dict[str, list[Owner]] = {}
    for owner, places in _owners(mission):
        for inside in sorted({place.inside for place in places}):
            here = [place for place in places if place.inside == inside]
            instances.setdefault(inside, []).append((owner, here))
    states: dict[str, Numbers] = {}
    ways: dict[Way, Numbers] = {}
    for number, problem in enumerate(problems, 1):
        inside = problem.place.inside
        for owners in [instances.get(inside, [])] if inside else instances.values():
            marked = _owner_of(owners, problem.place)
            if isinstance(marked, str):
                states[marked] = (*states.get(marked, ()), number)
            elif marked is not None:
                ways[marked] = (*ways.get(marked, ()), number)
    file = mission.place().file
    lines = tuple(_line(number, it, file) for number, it in enumerate(problems, 1))
    return Marks(states, ways, lines)


def numbered(numbers: Numbers) -> str:
    """Return the numbers as a drawing shows them.

    >>> numbered((1, 3))
    '[1, 3]'
    """
    return f"[{', '.join(map(str, numbers))}]" if numbers else ""


def _line(number: int, problem: Problem, file: str) -> str:
    """Return a problem in words; a file other than the mission's own is named."""
    place = problem.place
    name = "" if place.file in {"", file} else f"{PurePath(place.file).name} "
    return f"[{number}] {problem.level}, {name}line {place.line}: {problem.message}"


def _owner_of(owners: Sequence[Owner], place: Place) -> str | Way | None:
    """Return the first state or transition that has something at a place, or on its line."""
    exact = (owner for owner, places in owners if place in places)
    return next(exact, None) or _on_the_line(owners, place)


def _owners(mission: Mission) -> Iterator[Owner]:
    """Yield every state and transition with the places it is written at, its beginning first."""
    for name, state, _ in mission.walk():
        yield name, list(_of_state(state))
        for number, way in enumerate(state.transitions):
            yield (name, number), list(_of_way(way))


def _of_state(state: State) -> Iterator[Place]:
    yield from _of_part(state, set(State.model_fields) - {"transitions", "states"})
    yield from _of_part(state.invariant, set(type(state.invariant).model_fields))
    yield from (act.place for act in (*state.entry, *state.exit))
    if state.invariant.holds is not None:
        yield from _of_guard(state.invariant.holds)


def _of_way(way: Transition) -> Iterator[Place]:
    yield from _of_part(way, {field.alias or name for name, field in _WAY_FIELDS.items()})
    yield from (act.place for act in way.do)
    if way.when is not None:
        yield from _of_guard(way.when)


_WAY_FIELDS = Transition.model_fields


def _of_part(part: MissionPart, keys: set[str]) -> Iterator[Place]:
    if part.place().file:  # what a contract added stands nowhere
        yield part.place()
        yield from (part.place(key) for key in sorted(keys))


def _of_guard(guard: ex.Expression) -> Iterator[Place]:
    yield guard.place
    match guard:
        case ex.All(parts=parts) | ex.Any(parts=parts):
            for part in parts:
                yield from _of_guard(part)
        case ex.Not(part=part) | ex.Hysteresis(part=part):
            yield from _of_guard(part)
        case _:
            return


def _on_the_line(owners: Sequence[Owner], place: Place) -> str | Way | None:
    """Return the last state or transition that begins before a place on its line."""
    before = [
        (places[0].column, at)
        for at, (_, places) in enumerate(owners)
        if places
        and (places[0].file, places[0].line) == (place.file, place.line)
        and places[0].column <= place.column
    ]
    return owners[max(before)[1]][0] if before else None
