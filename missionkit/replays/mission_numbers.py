"""The numbers of a mission that decide when a transition is taken, and copies with others.

Those are the parameters of its guards, `for`, `after`, and the dwell of its state.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, TypeVar

from pydantic import BaseModel, ValidationError

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_definitions import Failsafe, State, Transition
from missionkit.chart.model.variables import is_number
from missionkit.errors import Place
from missionkit.plugin_protocols import WindowGuardProtocol

W = TypeVar("W", Transition, Failsafe)
P = TypeVar("P", Transition, Failsafe, State)
NewNumbers = Mapping[int, Mapping[str, Any]]  # by the identity of the owner, then by field
SHORTER = (-1,)
TIMES = {"for_": "for", "after": "after"}


class MissionNumber(NamedTuple):
    """A number of a mission file.

    Attributes:
        owner: what it belongs to: a guard, a transition, a failsafe or a state.
        field: its name there.
        key: its name in the mission file.
        where: the same in words, such as "near-goal: radius".
        value: as flown.
        place: of the owner.
        signs: ways in which it may let the transition be taken: -1 smaller, 1 larger.
        local: whether it matters only while the source of the transition is active.
    """

    owner: Any
    field: str
    key: str
    where: str
    value: float
    place: Place
    signs: tuple[int, ...] = (-1, 1)
    local: bool = False

    @property
    def whole(self) -> bool:
        """Whether it counts something."""
        return isinstance(self.value, int)


def numbers_of(
    mission: Mission, way: Transition | Failsafe, state: State | None, name: str
) -> Iterator[MissionNumber]:
    """Yield the numbers on which one transition depends.

    Args:
        mission: as loaded.
        way: one of its transitions or failsafes.
        state: the source of a transition.
        name: of that state, or of the failsafe.
    """
    if way.when is not None:
        inline = {id(part) for part in ex.parts_of(way.when)}
        for part in ex.opened([way.when], mission.guards):
            local = state is not None and id(part) in inline and not _remembers(part)
            for number in _of_guard(part, _name_of(part, mission.guards)):
                yield number._replace(local=local)
    local = state is not None
    for field, key in TIMES.items():
        value = getattr(way, field, None)
        if value:
            yield MissionNumber(
                way, field, key, f"{name}: {key}", value, way.place(), SHORTER, local
            )
    patient = isinstance(way, Transition) and not (way.emergency or way.event)
    if state is not None and patient:
        dwell = mission.dwell if state.dwell is None else state.dwell
        if dwell:
            place = state.place()
            yield MissionNumber(
                state, "dwell", "dwell", f"{name}: dwell", dwell, place, SHORTER, local
            )


def _remembers(part: ex.Expression) -> bool:
    """Say whether a guard has a memory that advances in every state."""
    window = isinstance(part, ex.Use) and isinstance(part.plugin, WindowGuardProtocol)
    return window or isinstance(part, ex.Hysteresis)


def _name_of(part: ex.Expression, named: Mapping[str, ex.Expression]) -> str:
    name = next((name for name, each in named.items() if each is part), None)
    return name or ex.text(part)


def _of_guard(part: ex.Expression, name: str) -> Iterator[MissionNumber]:
    match part:
        case ex.Use(plugin=BaseModel() as plugin, place=place):
            for field in type(plugin).model_fields:
                value = getattr(plugin, field)
                if is_number(value):
                    yield MissionNumber(part, field, field, f"{name}: {field}", value, place)
        case ex.Hysteresis(enter=enter, exit=leave, place=place):
            yield MissionNumber(part, "enter", "enter", f"{name}: enter", enter, place)
            yield MissionNumber(part, "exit", "exit", f"{name}: exit", leave, place)
        case ex.VariableGuard(op=op, value=value, place=place) if is_number(value):
            yield MissionNumber(part, "value", op, f"{name}: {op}", float(value), place)
        case _:
            pass


def with_numbers(
    mission: Mission, changes: Sequence[tuple[MissionNumber, float]]
) -> Mission | None:
    """Return a copy of a mission with other numbers; None: one may not have that value.

    Args:
        mission: as loaded.
        changes: its numbers, each with its new value.
    """
    new: dict[int, dict[str, float]] = {}
    for number, value in changes:
        new.setdefault(id(number.owner), {})[number.field] = value
    try:
        return mission.model_copy(
            update={
                "guards": {name: _guard(each, new) for name, each in mission.guards.items()},
                "failsafes": tuple(
                    _part(_asking(each, new), each, new) for each in mission.failsafes
                ),
                "states": _states(mission.states, new),
            }
        )
    except (ValidationError, TypeError, ValueError):
        return None


def _states(states: Mapping[str, State], new: NewNumbers) -> dict[str, State]:
    return {name: _state(each, new) for name, each in states.items()}


def _state(state: State, new: NewNumbers) -> State:
    promise = state.invariant.holds
    invariant = state.invariant
    if promise is not None:
        invariant = invariant.model_copy(update={"holds": _guard(promise, new)})
    changed = state.model_copy(
        update={
            "transitions": tuple(
                _part(_asking(each, new), each, new) for each in state.transitions
            ),
            "states": _states(state.states, new),
            "invariant": invariant,
        }
    )
    return _part(changed, state, new)


def _asking(way: W, new: NewNumbers) -> W:
    """Return a transition with its guard rebuilt."""
    return way if way.when is None else way.model_copy(update={"when": _guard(way.when, new)})


def _part(changed: P, owner: P, new: NewNumbers) -> P:
    """Return a transition, failsafe or state with its own numbers replaced.

    Raises:
        ValueError: a time is negative.
    """
    values = new.get(id(owner), {})
    if any(value < 0.0 for value in values.values()):
        raise ValueError
    return changed.model_copy(update=values) if values else changed


def _guard(guard: ex.Expression, new: NewNumbers) -> ex.Expression:
    """Return a guard with its numbers replaced.

    Raises:
        ValidationError: one may not have that value.
        ValueError: a latch would no longer be one, or would turn round.
    """
    values = new.get(id(guard), {})
    match guard:
        case ex.All(parts=parts) | ex.Any(parts=parts):
            return replace(guard, parts=tuple(_guard(part, new) for part in parts))
        case ex.Not(part=part):
            return replace(guard, part=_guard(part, new))
        case ex.Hysteresis(part=part):
            latch = replace(guard, part=_guard(part, new), **values)
            if (latch.enter - latch.exit) * (guard.enter - guard.exit) <= 0.0:
                raise ValueError
            return latch
        case ex.Use(plugin=plugin) if values:
            given = {name: getattr(plugin, name) for name in plugin.model_fields_set}
            return replace(guard, plugin=type(plugin)(**{**given, **values}))
        case ex.VariableGuard() if values:
            return replace(guard, **values)
        case _:
            return guard
