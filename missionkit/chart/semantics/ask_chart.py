"""Guards about the chart itself: its variables, and which of its states are active."""

from __future__ import annotations

import operator
from collections.abc import Callable

from missionkit.chart.model import expressions as ex
from missionkit.chart.model.variables import is_number
from missionkit.chart.semantics.compiled import Ask, Question
from missionkit.messages import Verdict

YES, NO = Verdict(holds=True), Verdict(holds=False)
_COMPARED: dict[str, Callable[[float, float], bool]] = {
    "equals": operator.eq,
    "below": operator.lt,
    "above": operator.gt,
    "at_least": operator.ge,
    "at_most": operator.le,
}


def of_chart(expression: ex.Variable | ex.In | ex.Finished) -> Ask:
    """Return the closure that answers a guard about the chart."""
    match expression:
        case ex.Variable(name=name, op="equals", value=value) if not is_number(value):
            return lambda question: YES if question.variables[name] == value else NO
        case ex.Variable(name=name, op=op, value=value):
            return _compared(name, op, float(value))
        case ex.In(state=state):
            return lambda question: YES if state in question.active else NO
        case ex.Finished(groups=groups):
            return _finished(groups)


def _compared(name: str, op: str, threshold: float) -> Ask:
    compare = _COMPARED[op]
    sign = -1.0 if op in {"below", "at_most"} else 1.0

    def ask(question: Question) -> Verdict:
        value = float(question.variables[name])
        gap = value - threshold
        margin = -abs(gap) if op == "equals" else sign * gap
        return Verdict(compare(value, threshold), "", value, threshold, margin)

    return ask


def _finished(groups: tuple[tuple[str, ...], ...]) -> Ask:
    def ask(question: Question) -> Verdict:
        active = question.active
        done = all(any(name in active for name in group) for group in groups)
        return YES if done else NO

    return ask
