"""Effect of actions on variables, and matching of events to transitions."""

from __future__ import annotations

from collections.abc import Mapping

from missionkit.chart.model.variables import Value, Values, Variable, is_number
from missionkit.chart.semantics.compiled_chart import Output


def matches(descriptors: tuple[str, ...], event: str) -> bool:
    """Say whether an event is one of those described: `a` also means `a.b`, `*` any."""
    for each in descriptors:
        if each in {event, "*"} or (event.startswith(each) and event[len(each)] == "."):
            return True
    return False


def assigned(
    variables: Mapping[str, Variable], values: Values, output: Output
) -> tuple[Values, str]:
    """Return the values after an assignment, and what was wrong with it.

    A value that is not of the variable's type or outside its range changes nothing.

    Args:
        variables: declarations, with type and range.
        values: before the assignment; never changed.
        output: variable and operand.

    Returns:
        New values and "", or the old ones and a sentence for the record.
    """
    name = output.text
    value = _value(values, output)
    if value is None or not variables[name].admits(value):
        shown = output.operand if value is None else value
        return (
            values,
            f"assign {name}: {shown} is not a valid value of {name}; it stays {values[name]}",
        )
    if isinstance(variables[name].initial, float):
        value = float(value)
    return {**values, name: value}, ""


def _value(values: Values, output: Output) -> Value | None:
    before, operand = values[output.text], output.operand
    if output.operation == "add":
        return before + operand if is_number(before) and is_number(operand) else None
    if output.operation == "copy":
        return values.get(str(operand))
    if output.operation == "toggle":
        return before != bool(operand) if isinstance(before, bool) else None
    return operand


def in_words(output: Output) -> str:
    """Return what an output does, for the record: "log hello", "assign tries add 1"."""
    assigned = f"{output.verb} {output.text}"
    match output.operation:
        case "":
            return assigned
        case "set":
            return f"{assigned} = {output.operand}"
        case "toggle":
            return f"{assigned} toggled"
        case operation:
            return f"{assigned} {operation} {output.operand}"
