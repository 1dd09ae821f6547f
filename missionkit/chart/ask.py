"""Guard expressions compiled to closures, in three-valued logic (Kleene)."""

from __future__ import annotations

import math
from collections.abc import Callable
from numbers import Real
from typing import Any as Anything
from typing import cast

from missionkit.chart import expressions as ex
from missionkit.chart.ask_chart import of_chart
from missionkit.chart.compiled import Ask, Question, Slot
from missionkit.messages import Estimate, Verdict
from missionkit.plugin import Guard, Plugin, WindowGuard

Check = Callable[[Estimate], Verdict]
_TRUTHS = frozenset((bool, type(None)))
_NUMBERS = frozenset((float, type(None)))


class Asker:
    """Compiles the guards of one mission; guards that remember share their slots by name."""

    def __init__(self, named: dict[str, ex.Expression]) -> None:
        self._named = named
        self._compiled: dict[str, Ask] = {}
        self._meanings: dict[str, object] = {name: name for name in named}
        self.slots: list[Slot] = []

    def ask(self, expression: ex.Expression) -> Ask:
        """Return the closure that answers `expression`."""
        match expression:
            case ex.Named():
                name = self.name(expression)
                return self._remembered(name, lambda: self._guard(name))
            case ex.Use():
                name = self.name(expression)
                return self._remembered(name, lambda: self._plugin(name, expression.plugin))
            case ex.All(parts=parts) | ex.Any(parts=parts):
                joined = _all if isinstance(expression, ex.All) else _any
                return joined(tuple(self.ask(part) for part in parts))
            case ex.Not(part=part):
                return _not(self.ask(part))
            case ex.Hysteresis():
                name = self.name(expression)
                return self._remembered(name, lambda: self._latch(name, expression))
            case ex.Variable() | ex.In() | ex.Finished():
                name = self.name(expression)
                return self._remembered(name, lambda: _answered(name, of_chart(expression)))

    def check(self, expression: ex.Expression) -> Check | None:
        """Return what to ask if `expression` is one guard of the package that remembers nothing."""
        if isinstance(expression, ex.Named):
            expression = self._named[expression.name]
        if not isinstance(expression, ex.Use) or not isinstance(expression.plugin, Guard):
            return None
        return None if _is_foreign(expression.plugin) else expression.plugin.check

    def name(self, expression: ex.Expression) -> str:
        """Return what the record calls a guard: its text, numbered where two read the same."""
        said, count = str(ex.text(expression)), 1
        meaning: object
        match expression:
            case ex.Use():
                meaning = expression.plugin
            case ex.Hysteresis(part=part, enter=enter, exit=leave):
                meaning = (self.name(part), enter, leave)
            case ex.Variable(name=of, op=op, value=value):
                meaning = (of, op, value)
            case ex.In(state=state) | ex.Finished(state=state):
                meaning = (type(expression), state)
            case _:
                return said
        name = said
        while self._meanings.setdefault(name, meaning) != meaning:
            count += 1
            name = f"{said} ({count})"
        return name

    def _remembered(self, name: str, compile_it: Callable[[], Ask]) -> Ask:
        if name not in self._compiled:
            self._compiled[name] = compile_it()
        return self._compiled[name]

    def _guard(self, name: str) -> Ask:
        expression = self._named[name]
        if isinstance(expression, ex.Use):
            return self._plugin(name, expression.plugin)
        return _answered(name, self.ask(expression))

    def _plugin(self, name: str, plugin: Plugin) -> Ask:
        foreign = _is_foreign(plugin)
        if isinstance(plugin, WindowGuard):
            slot = self._slot(name, plugin.begin, _advancing(name, plugin, foreign=foreign))
            return _answered(name, _window(name, plugin, slot, foreign=foreign))
        if not foreign:
            return _trusting(name, cast(Guard, plugin))
        return _answered(name, _simple(name, cast(Guard, plugin)))

    def _latch(self, name: str, latch: ex.Hysteresis) -> Ask:
        inner = self.ask(latch.part)
        slot = self._slot(name, lambda: False, _latching(inner, latch))

        def ask(question: Question) -> Verdict:
            verdict, on = inner(question), question.windows[slot]
            if verdict.value is None:
                return Verdict.unknown(verdict.why or "the guard gives no value")
            threshold = latch.exit if on else latch.enter
            sign = 1.0 if latch.enter >= latch.exit else -1.0
            margin = sign * (verdict.value - threshold)
            return Verdict(on, verdict.why, verdict.value, threshold, margin)

        return _answered(name, ask)

    def _slot(
        self,
        name: str,
        begin: Callable[[], Anything],
        advance: Callable[[Anything, Question], Anything],
    ) -> int:
        self.slots.append(Slot(name, begin, advance))
        return len(self.slots) - 1


def _is_foreign(plugin: Plugin) -> bool:
    return not type(plugin).__module__.startswith("missionkit.")


def _answered(name: str, ask: Ask) -> Ask:
    """Ask once a tick and keep the answer for the record."""

    def once(question: Question) -> Verdict:
        known = question.answers.get(name)
        if known is None:
            known = question.answers[name] = ask(question)
        return known

    return once


def _simple(name: str, guard: Guard) -> Ask:
    check = guard.check

    def ask(question: Question) -> Verdict:
        boxed = question.contain.call(name, check, question.seen)
        return _trusted(name, boxed, question)

    return ask


def _trusting(name: str, guard: Guard) -> Ask:
    """Ask a guard of the package once a tick; its types are known, so only odd numbers are slow.

    This is the innermost of the tick: one closure instead of three.
    """
    check = guard.check

    def ask(question: Question) -> Verdict:
        answers = question.answers
        if name in answers:
            return answers[name]
        try:
            verdict = check(question.seen)
        except Exception as error:  # noqa: BLE001 - even our own guards must not end a flight
            question.contain.note(f"{name} raised {type(error).__name__}: {error}")
            verdict = Verdict.unknown("the guard failed")
        if not is_sound(verdict):
            verdict = _trusted(name, (verdict,), question)
        answers[name] = verdict
        return verdict

    return ask


def is_sound(verdict: Verdict) -> bool:
    """Say whether a verdict of the package's own guards is fit for the record at once.

    A margin is the distance from the threshold, so it is neither NaN nor infinite if the value
    is not.
    """
    holds, _, value, _, margin = verdict
    if type(holds) not in _TRUTHS:
        return False
    if margin is None:
        return value is None
    return type(margin) is float and margin - margin == 0.0


def _window(name: str, guard: WindowGuard, slot: int, *, foreign: bool) -> Ask:
    check = guard.check

    def ask(question: Question) -> Verdict:
        memory = question.windows[slot]
        boxed = question.contain.call(name, check, memory, question.seen, foreign=foreign)
        return _trusted(name, boxed, question)

    return ask


def _advancing(
    name: str, guard: WindowGuard, *, foreign: bool
) -> Callable[[Anything, Question], Anything]:
    step = guard.advance

    def advance(memory: Anything, question: Question) -> Anything:
        boxed = question.contain.call(name, step, memory, question.seen, foreign=foreign)
        return memory if boxed is None else boxed[0]

    return advance


def _latching(inner: Ask, latch: ex.Hysteresis) -> Callable[[Anything, Question], bool]:
    rising = latch.enter >= latch.exit

    def advance(on: Anything, question: Question) -> bool:
        value = inner(question).value
        if value is None:
            return bool(on)
        threshold = latch.exit if on else latch.enter
        return value >= threshold if rising else value <= threshold

    return advance


def _trusted(name: str, boxed: tuple[object] | None, question: Question) -> Verdict:
    """Return the verdict if it can be used; note what is wrong with it if not."""
    if boxed is None:
        return Verdict.unknown("the guard failed")
    (answer,) = boxed
    if not isinstance(answer, Verdict):
        question.contain.note(f"{name} answered {type(answer).__name__}, expected a Verdict")
        return Verdict.unknown("the guard's answer cannot be used")
    verdict = answer if _native(answer) else _plain(answer)
    if verdict is None:
        question.contain.note(f"{name} answered a Verdict of {answer.holds!r}, {answer.value!r}")
        return Verdict.unknown("the guard's answer cannot be used")
    if _finite(verdict):
        return verdict
    question.contain.note(f"{name} answered with a number that is not finite")
    return Verdict.unknown("the guard's number is not finite")


def _native(answer: Verdict) -> bool:
    """Say whether a verdict is made of Python's own types already, as nearly all are."""
    holds, why, *numbers = map(type, answer)
    return holds is bool and why is str and _NUMBERS.issuperset(numbers)


def _plain(answer: Verdict) -> Verdict | None:
    """Return a verdict in Python's own truth values and numbers, `None` if that cannot be done.

    A comparison of numpy numbers gives a truth value that is neither `True` nor `False`.
    """
    holds: object = answer.holds
    numbers = answer[2:]
    if not all(number is None or isinstance(number, Real) for number in numbers):
        return None
    if holds is not None and type(holds).__name__ != "bool":
        return None
    holds = None if holds is None else bool(holds)
    value, threshold, margin = (None if n is None else float(n) for n in numbers)
    return Verdict(holds, str(answer.why), value, threshold, margin)


def _finite(verdict: Verdict) -> bool:
    return (
        math.isfinite(verdict.value or 0.0)
        and not math.isnan(verdict.threshold or 0.0)
        and not math.isnan(verdict.margin or 0.0)
    )


def _all(parts: tuple[Ask, ...]) -> Ask:
    def ask(question: Question) -> Verdict:
        verdicts = [part(question) for part in parts]
        return _first(verdicts, holds=False) or _first(verdicts, holds=None) or Verdict(holds=True)

    return ask


def _any(parts: tuple[Ask, ...]) -> Ask:
    def ask(question: Question) -> Verdict:
        verdicts = [part(question) for part in parts]
        return _first(verdicts, holds=True) or _first(verdicts, holds=None) or Verdict(holds=False)

    return ask


def _not(part: Ask) -> Ask:
    def ask(question: Question) -> Verdict:
        verdict = part(question)
        holds = None if verdict.holds is None else not verdict.holds
        margin = None if verdict.margin is None else -verdict.margin
        return verdict._replace(holds=holds, margin=margin)

    return ask


def _first(verdicts: list[Verdict], *, holds: bool | None) -> Verdict | None:
    return next((verdict for verdict in verdicts if verdict.holds is holds), None)
