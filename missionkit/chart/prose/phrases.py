"""Guards, transitions and actions as parts of a sentence."""

from __future__ import annotations

from collections.abc import Iterable

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.actions import Act, Assign, Cancel, Log, Order, Raise
from missionkit.chart.model.state_definitions import Transition

DONE_GUARD = "done"
OWN_DONE = "its behaviour is done"


def listed(words: Iterable[str], last: str = "and") -> str:
    """Return words as a list in a sentence.

    >>> listed(["gps", "visual", "task"])
    'gps, visual and task'
    """
    every = list(words)
    return f" {last} ".join([", ".join(every[:-1]), every[-1]] if len(every) > 1 else every)


def guard(expression: ex.Expression, done: str = OWN_DONE) -> str:
    """Return a guard as a clause, "near and sure hold"; `done` is what the guard `done` means."""
    match expression:
        case ex.All(parts=parts) | ex.Any(parts=parts):
            return _joined(expression, parts, done)
        case ex.Not(part=part):
            return _negated(part, done)
        case ex.Use(kind=kind) if kind == DONE_GUARD:
            return done
        case ex.In() | ex.Finished() | ex.VariableGuard():
            return _of_chart(expression)
        case _:
            return f"{ex.text(expression)} holds"


def _joined(both: ex.All | ex.Any, parts: Iterable[ex.Expression], done: str) -> str:
    word = "and" if isinstance(both, ex.All) else "or"
    every = list(parts)
    if all(map(_is_noun, every)):
        return f"{listed(map(ex.text, every), word)} hold{'' if word == 'and' else 's'}"
    clauses = [guard(part, done) for part in every]
    grouped = [
        f"({clause})" if isinstance(part, ex.All | ex.Any) else clause
        for part, clause in zip(every, clauses, strict=True)
    ]
    return listed(grouped, word)


def _negated(part: ex.Expression, done: str) -> str:
    if _is_noun(part):
        return f"{ex.text(part)} does not hold"
    if isinstance(part, ex.Use):
        return f"it is not true that {done}"
    return f"it is not true that {guard(part, done)}"


def _is_noun(expression: ex.Expression) -> bool:
    """Say whether a guard is a name, of which one says that it holds."""
    if isinstance(expression, ex.Use):
        return expression.kind != DONE_GUARD
    return isinstance(expression, ex.Named | ex.Hysteresis)


def _of_chart(expression: ex.In | ex.Finished | ex.VariableGuard) -> str:
    match expression:
        case ex.In(state=state):
            return f"{state} is active"
        case ex.Finished(state=state):
            return f"{state} is done"
        case ex.VariableGuard(name=name, op=op, value=operand):
            return f"{name} {_COMPARISON_WORDS[op]} {value(operand)}"


_COMPARISON_WORDS = {
    "equals": "equals",
    "below": "is below",
    "above": "is above",
    "at_least": "is at least",
    "at_most": "is at most",
}


def reason(transition: Transition, done: str = OWN_DONE) -> str:
    """Say when a transition is taken: "when near holds, for 2 s without a break"."""
    parts = []
    if transition.event:
        parts.append(f"on the event {listed(transition.event, 'or')}")
    if transition.when is not None:
        parts.append(held(transition.when, transition.for_, done))
    if transition.after is not None:
        parts.append("at once" if transition.after == 0 else f"after {transition.after:g} s in it")
    return listed(parts)


def held(when: ex.Expression, seconds: float, done: str = OWN_DONE) -> str:
    """Say that a guard must hold, and how long.

    Args:
        when: the guard's expression.
        seconds: for which it must hold; 0 for at once.
        done: words for a behaviour that has finished.
    """
    lasting = f", for {seconds:g} s without a break" if seconds else ""
    return f"when {guard(when, done)}{lasting}"


def actions(every: Iterable[Act]) -> str:
    """Return actions as a clause: "logs 'seen' and adds 1 to tries"."""
    return listed(map(action, every))


def action(act: Act) -> str:
    """Return one action as a clause."""
    match act:
        case Log(text=text):
            return f"logs {text!r}"
        case Raise(event=event, after=after):
            return f"raises {event}{_later(after)}"
        case Cancel(event=event):
            return f"cancels the delayed {event}"
        case Order(action=word):
            return f"asks the autopilot to {word}"
        case Assign():
            return _assigned(act)


def _later(after: float | str | None) -> str:
    if isinstance(after, str):
        return f" after the time in {after}"
    return f" after {after:g} s" if after else ""


def _assigned(act: Assign) -> str:
    match act.operation:
        case "add":
            return f"adds {value(act.operand)} to {act.variable}"
        case "copy":
            return f"copies {act.operand} to {act.variable}"
        case "toggle":
            return f"toggles {act.variable}"
        case _:
            return f"sets {act.variable} to {value(act.operand)}"


def value(it: object) -> str:
    """Return a value as mission files write it."""
    if isinstance(it, bool):
        return str(it).lower()
    if isinstance(it, tuple):
        return f"[{', '.join(map(value, it))}]"
    return f"{it:g}" if isinstance(it, float) else str(it)


def counted(number: int, what: str) -> str:
    """Return a number of things: "1 state", "7 states"."""
    return f"{number} {what}{'' if number == 1 else 's'}"
