"""Guard expressions compiled to closures, in three-valued logic (Kleene)."""

from __future__ import annotations

from collections.abc import Callable
from operator import eq, ge, gt, le, lt
from typing import Any as Anything
from typing import cast

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.variables import is_number
from missionkit.chart.semantics.compiled_chart import (
    AskedGuard,
    GuardContext,
    GuardFunction,
    GuardMemory,
)
from missionkit.chart.semantics.verdict_validation import is_sound, trusted
from missionkit.errors import NO_PLACE
from missionkit.guards.comparison import ComparedGuard, FlagGuard, compiled
from missionkit.messages import CameraModel, Estimate, Verdict
from missionkit.plugin import Plugin, WindowGuard
from missionkit.plugin_containment import is_foreign
from missionkit.plugin_protocols import (
    CompositeGuardProtocol,
    GuardProtocol,
    Inputs,
    WindowGuardProtocol,
)

Check = Callable[[Estimate], Verdict]
TRUE_VERDICT, FALSE_VERDICT = Verdict(holds=True), Verdict(holds=False)
_COMPARE: dict[str, Callable[[float, float], bool]] = {
    "equals": eq,
    "below": lt,
    "above": gt,
    "at_least": ge,
    "at_most": le,
}


class GuardCompiler:
    """Compiles the guards of one mission; guards that remember share their slots by name."""

    def __init__(self, named: dict[str, ex.Expression], camera: CameraModel | None = None) -> None:
        self._named, self._camera = named, camera
        self._compiled: dict[str, GuardFunction] = {}
        self._meanings: dict[str, object] = {name: name for name in named}
        self.slots: list[GuardMemory] = []

    def ask(self, expression: ex.Expression) -> GuardFunction:
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
            case ex.VariableGuard() | ex.In() | ex.Finished():
                name = self.name(expression)
                return self._remembered(name, lambda: answered(name, of_chart(expression)))

    def asked(self, expression: ex.Expression, *, unknown_takes: bool = False) -> AskedGuard:
        """Return how the quick step asks a guard.

        Args:
            expression: the guard.
            unknown_takes: unknown counts as holding.
        """
        ask, guard = self.ask(expression), self._own(expression)
        if guard is None:
            return AskedGuard(ask, unknown_takes)
        plain = AskedGuard(ask, unknown_takes, self.name(expression), _check(guard))
        if isinstance(guard, FlagGuard):
            return plain._replace(measure=guard.raised)
        if not isinstance(guard, ComparedGuard):
            return plain
        _, operator, threshold, why = guard.comparison()
        return plain._replace(
            measure=guard.measured,
            rising=operator in {"above", "at_least"},
            strict=operator in {"above", "below"},
            threshold=threshold,
            why=why,
        )

    def _own(self, expression: ex.Expression) -> GuardProtocol | None:
        """Return the guard if it is one of the package that needs no more than the estimate."""
        if isinstance(expression, ex.Named):
            expression = self._named[expression.name]
        if not isinstance(expression, ex.Use):
            return None
        plugin = expression.plugin
        if is_foreign(plugin) or isinstance(plugin, WindowGuardProtocol):
            return None
        return cast(GuardProtocol, plugin)

    def name(self, expression: ex.Expression) -> str:
        """Return what the record calls a guard: its text, numbered where two read the same."""
        written, count = str(ex.text(expression)), 1
        meaning: object
        match expression:
            case ex.Use():
                meaning = expression.plugin
            case ex.Hysteresis(part=part, enter=enter, exit=leave):
                meaning = (self.name(part), enter, leave)
            case ex.VariableGuard(name=of, op=op, value=value):
                meaning = (of, op, value)
            case ex.In(state=state) | ex.Finished(state=state):
                meaning = (type(expression), state)
            case _:
                return written
        name = written
        while self._meanings.setdefault(name, meaning) != meaning:
            count += 1
            name = f"{written} ({count})"
        return name

    def _remembered(self, name: str, compile_it: Callable[[], GuardFunction]) -> GuardFunction:
        if name not in self._compiled:
            self._compiled[name] = compile_it()
        return self._compiled[name]

    def _guard(self, name: str) -> GuardFunction:
        expression = self._named[name]
        if isinstance(expression, ex.Use):
            return self._plugin(name, expression.plugin)
        return answered(name, self.ask(expression))

    def _plugin(self, name: str, plugin: Plugin) -> GuardFunction:
        foreign = is_foreign(plugin)
        if isinstance(plugin, CompositeGuardProtocol):  # it has all that a window guard has
            return answered(name, self._composite(name, plugin, foreign=foreign))
        if isinstance(plugin, WindowGuard) and not foreign and self._camera is not None:
            plugin = plugin.with_camera(self._camera)
        if isinstance(plugin, WindowGuardProtocol):
            advance = _advancing(name, plugin, foreign=foreign)
            slot = self._slot(GuardMemory(name, plugin.begin, advance, plugin.resumed))
            return answered(name, _window(name, plugin, slot, foreign=foreign))
        if not foreign:
            return _trusting(name, cast(GuardProtocol, plugin))
        return answered(name, _simple(name, cast(GuardProtocol, plugin)))

    def _composite(
        self, name: str, guard: CompositeGuardProtocol, *, foreign: bool
    ) -> GuardFunction:
        """Compile what the guard reads first: its memory then stands in a later slot."""
        names = [it.name for it in guard.named_inputs() if it.what == "guard"]
        parts = {each: self.ask(ex.Named(each, NO_PLACE)) for each in dict.fromkeys(names)}
        advance = _advancing(name, guard, foreign=foreign)
        slot = self._slot(GuardMemory(name, guard.begin, advance, guard.resumed))
        check = guard.check

        def ask(question: GuardContext) -> Verdict:
            answers = {each: part(question) for each, part in parts.items()}
            inputs = Inputs(answers, question.variables, question.active)
            memory = question.windows[slot]
            boxed = question.contain.call(
                name, check, memory, question.seen, inputs, foreign=foreign
            )
            return trusted(name, boxed, question)

        return ask

    def _latch(self, name: str, latch: ex.Hysteresis) -> GuardFunction:
        inner = self.ask(latch.part)
        slot = self._slot(GuardMemory(name, lambda: False, _latching(inner, latch)))

        def ask(question: GuardContext) -> Verdict:
            verdict, on = inner(question), question.windows[slot]
            if verdict.value is None:
                return Verdict.unknown(verdict.why or "the guard gives no value")
            threshold = latch.exit if on else latch.enter
            sign = 1.0 if latch.enter >= latch.exit else -1.0
            margin = sign * (verdict.value - threshold)
            return Verdict(on, verdict.why, verdict.value, threshold, margin)

        return answered(name, ask)

    def _slot(self, slot: GuardMemory) -> int:
        self.slots.append(slot)
        return len(self.slots) - 1


def answered(name: str, ask: GuardFunction) -> GuardFunction:
    """Return a closure that asks once a tick and keeps the answer for the record."""

    def once(question: GuardContext) -> Verdict:
        known = question.answers.get(name)
        if known is None:
            known = question.answers[name] = ask(question)
        return known

    return once


def _check(guard: GuardProtocol) -> Check:
    return compiled(guard) if isinstance(guard, ComparedGuard) else guard.check


def _simple(name: str, guard: GuardProtocol) -> GuardFunction:
    check = guard.check

    def ask(question: GuardContext) -> Verdict:
        boxed = question.contain.call(name, check, question.seen)
        return trusted(name, boxed, question)

    return ask


def _trusting(name: str, guard: GuardProtocol) -> GuardFunction:
    """Ask a guard of the package once a tick; its types are known, so only odd numbers are slow.

    This is the innermost of the tick: one closure instead of three.
    """
    check = _check(guard)

    def ask(question: GuardContext) -> Verdict:
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


def _window(name: str, guard: WindowGuardProtocol, slot: int, *, foreign: bool) -> GuardFunction:
    check = guard.check

    def ask(question: GuardContext) -> Verdict:
        memory = question.windows[slot]
        boxed = question.contain.call(name, check, memory, question.seen, foreign=foreign)
        return trusted(name, boxed, question)

    return ask


def _advancing(
    name: str, guard: WindowGuardProtocol | CompositeGuardProtocol, *, foreign: bool
) -> Callable[[Anything, GuardContext], Anything]:
    step = guard.advance

    def advance(memory: Anything, question: GuardContext) -> Anything:
        boxed = question.contain.call(name, step, memory, question.seen, foreign=foreign)
        return memory if boxed is None else boxed[0]

    return advance


def _latching(
    inner: GuardFunction, latch: ex.Hysteresis
) -> Callable[[Anything, GuardContext], bool]:
    rising = latch.enter >= latch.exit

    def advance(on: Anything, question: GuardContext) -> bool:
        value = inner(question).value
        if value is None:
            return bool(on)
        threshold = latch.exit if on else latch.enter
        return value >= threshold if rising else value <= threshold

    return advance


def _all(parts: tuple[GuardFunction, ...]) -> GuardFunction:
    def ask(question: GuardContext) -> Verdict:
        verdicts = [part(question) for part in parts]
        return _first(verdicts, holds=False) or _first(verdicts, holds=None) or Verdict(holds=True)

    return ask


def _any(parts: tuple[GuardFunction, ...]) -> GuardFunction:
    def ask(question: GuardContext) -> Verdict:
        verdicts = [part(question) for part in parts]
        return _first(verdicts, holds=True) or _first(verdicts, holds=None) or Verdict(holds=False)

    return ask


def _not(part: GuardFunction) -> GuardFunction:
    def ask(question: GuardContext) -> Verdict:
        verdict = part(question)
        holds = None if verdict.holds is None else not verdict.holds
        margin = None if verdict.margin is None else -verdict.margin
        return Verdict(holds, verdict.why, verdict.value, verdict.threshold, margin)

    return ask


def _first(verdicts: list[Verdict], *, holds: bool | None) -> Verdict | None:
    return next((verdict for verdict in verdicts if verdict.holds is holds), None)


def of_chart(expression: ex.VariableGuard | ex.In | ex.Finished) -> GuardFunction:
    """Return the closure that answers a guard about the chart."""
    match expression:
        case ex.VariableGuard(name=name, op="equals", value=value) if not is_number(value):
            return lambda question: (
                TRUE_VERDICT if question.variables[name] == value else FALSE_VERDICT
            )
        case ex.VariableGuard(name=name, op=op, value=value):
            return _compared(name, op, float(value))
        case ex.In(state=state):
            return lambda question: TRUE_VERDICT if state in question.active else FALSE_VERDICT
        case ex.Finished(groups=groups):
            return _finished(groups)


def _compared(name: str, op: str, threshold: float) -> GuardFunction:
    compare = _COMPARE[op]
    sign = -1.0 if op in {"below", "at_most"} else 1.0

    def ask(question: GuardContext) -> Verdict:
        value = float(question.variables[name])
        gap = value - threshold
        margin = -abs(gap) if op == "equals" else sign * gap
        return Verdict(compare(value, threshold), "", value, threshold, margin)

    return ask


def _finished(groups: tuple[tuple[str, ...], ...]) -> GuardFunction:
    def ask(question: GuardContext) -> Verdict:
        active = question.active
        done = all(any(name in active for name in group) for group in groups)
        return TRUE_VERDICT if done else FALSE_VERDICT

    return ask
