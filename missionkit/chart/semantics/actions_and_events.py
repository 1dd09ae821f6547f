"""Effect of actions on variables, and matching of events to transitions."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence

from missionkit.chart.model.variables import Value, Values, Variable, is_number
from missionkit.chart.semantics.chart_memory import DelayedEvent
from missionkit.chart.semantics.compiled_chart import Output

MOST_DELAYED = 64  # delayed events that may be under way at once


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


def delay_of(values: Values, output: Output) -> tuple[float, str]:
    """Return after how long (s) a delayed event is to come, and what was wrong with that."""
    operand = output.operand
    delay = values[operand] if isinstance(operand, str) else operand
    if is_number(delay) and 0.0 <= delay < math.inf:
        return float(delay), ""
    return 0.0, f"{in_words(output)}: {delay} is not a valid delay; the event is not raised"


def scheduled(
    delayed: Sequence[DelayedEvent], due: float, event: str
) -> tuple[tuple[DelayedEvent, ...], str]:
    """Return the delayed events with one more, and what was wrong with that.

    Args:
        delayed: under way, the next first.
        due: s, when the new one is to come; at equal times it comes after the others.
        event: its name.
    """
    if len(delayed) >= MOST_DELAYED:
        return tuple(delayed), f"raise {event}: {MOST_DELAYED} delayed events are under way already"
    place = bisect_right(delayed, due, key=lambda each: each.due)
    return (*delayed[:place], DelayedEvent(due, event), *delayed[place:]), ""


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
        case "after":
            unit = "" if isinstance(output.operand, str) else " s"
            return f"{assigned} after {output.operand}{unit}"
        case operation:
            return f"{assigned} {operation} {output.operand}"
