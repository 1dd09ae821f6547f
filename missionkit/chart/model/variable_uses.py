"""Whether guards and actions use the mission's variables as their types allow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.actions import Assign, Raise
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.traversal import actions_of, guards_of
from missionkit.chart.model.variables import Variable, alike, is_number
from missionkit.errors import Problem

Variables = Mapping[str, Variable]


def problems_of(mission: Mission) -> Iterator[Problem]:
    """Yield a problem for each comparison or assignment that can never be right."""
    for action in actions_of(mission):
        match action:
            case Assign(variable=name):
                wrong, what = _assigned(mission.variables, action), f"assign {name}"
            case Raise(event=event, after=str(name)):
                wrong, what = _delayed(mission.variables[name]), f"raise {event} after {name}"
            case _:
                continue
        if wrong:
            yield Problem(action.place, f"{what}: {wrong}")
    for guard in guards_of(mission):
        for part in ex.parts_of(guard):
            if isinstance(part, ex.VariableGuard):
                yield from _compared(mission.variables, part)
        yield from _read(mission.variables, guard)


def _assigned(variables: Variables, action: Assign) -> str:
    variable = variables[action.variable]
    numeric = is_number(variable.initial)
    operand = action.operand
    if action.operation == "add" and not (numeric and is_number(operand)):
        return f"only a number can be added to a number; it is {variable.type_name}"
    if action.operation == "toggle" and not isinstance(variable.initial, bool):
        return f"only true and false can be toggled; it is {variable.type_name}"
    if action.operation == "copy":
        other = variables[str(operand)]
        if other.type_name != variable.type_name:
            return f"it is {variable.type_name}, {operand!r} is {other.type_name}"
    if action.operation == "set" and not variable.admits(operand):
        return f"expected {variable.described}, got {operand!r}"
    if isinstance(variable.initial, int) and isinstance(operand, float):
        return "it is a whole number; write its initial value with a decimal point, 0.0"
    return ""


def _delayed(variable: Variable) -> str:
    if not is_number(variable.initial):
        return f"a delay is a number; it is {variable.type_name}"
    if variable.max is not None and variable.max < 0.0:
        return f"a delay is not negative; it is {variable.described}"
    return ""


def _read(variables: Variables, guard: ex.Expression) -> Iterator[Problem]:
    for name, place in ex.variables_in(guard):
        variable = variables[name]
        if isinstance(variable.initial, str):
            what = f"the guard reads {name} as a number: it is {variable.type_name}"
            yield Problem(place, what)


def _compared(variables: Variables, guard: ex.VariableGuard) -> Iterator[Problem]:
    variable, value = variables[guard.name], guard.value
    if not alike(variable.initial, value):
        comparison_text = f"{guard.name} {guard.op.replace('_', ' ')} {value!r}"
        yield Problem(guard.place, f"{comparison_text}: it is {variable.type_name}")
