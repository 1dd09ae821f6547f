"""Guard expressions compiled to closures, in three-valued logic (Kleene)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any as Anything
from typing import cast

from missionkit.chart.model import expressions as ex
from missionkit.chart.semantics.ask_chart import of_chart
from missionkit.chart.semantics.compiled import Ask, Question, Slot
from missionkit.chart.semantics.contain import is_foreign
from missionkit.chart.semantics.trust import is_sound, trusted
from missionkit.messages import Estimate, Verdict
from missionkit.plugin import Guard, Plugin, WindowGuard

Check = Callable[[Estimate], Verdict]


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
        return None if is_foreign(expression.plugin) else expression.plugin.check

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
        foreign = is_foreign(plugin)
        if isinstance(plugin, WindowGuard):
            advance = _advancing(name, plugin, foreign=foreign)
            slot = self._slot(Slot(name, plugin.begin, advance, plugin.resumed))
            return _answered(name, _window(name, plugin, slot, foreign=foreign))
        if not foreign:
            return _trusting(name, cast(Guard, plugin))
        return _answered(name, _simple(name, cast(Guard, plugin)))

    def _latch(self, name: str, latch: ex.Hysteresis) -> Ask:
        inner = self.ask(latch.part)
        slot = self._slot(Slot(name, lambda: False, _latching(inner, latch)))

        def ask(question: Question) -> Verdict:
            verdict, on = inner(question), question.windows[slot]
            if verdict.value is None:
                return Verdict.unknown(verdict.why or "the guard gives no value")
            threshold = latch.exit if on else latch.enter
            sign = 1.0 if latch.enter >= latch.exit else -1.0
            margin = sign * (verdict.value - threshold)
            return Verdict(on, verdict.why, verdict.value, threshold, margin)

        return _answered(name, ask)

    def _slot(self, slot: Slot) -> int:
        self.slots.append(slot)
        return len(self.slots) - 1


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
        return trusted(name, boxed, question)

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
            verdict = trusted(name, (verdict,), question)
        answers[name] = verdict
        return verdict

    return ask


def _window(name: str, guard: WindowGuard, slot: int, *, foreign: bool) -> Ask:
    check = guard.check

    def ask(question: Question) -> Verdict:
        memory = question.windows[slot]
        boxed = question.contain.call(name, check, memory, question.seen, foreign=foreign)
        return trusted(name, boxed, question)

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
