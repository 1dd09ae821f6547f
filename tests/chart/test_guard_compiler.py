"""Guard expressions: three-valued logic, memories, and guards that cannot be trusted."""

from __future__ import annotations

import math
from itertools import product
from typing import Any, ClassVar

import numpy as np
import pytest
from samples import calm
from stepping import CATALOGUE, Tally, Walk, chart_of
from typing_extensions import override

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.semantics.chart_compiler import NO_PLACE
from missionkit.chart.semantics.compiled_chart import GuardContext
from missionkit.chart.semantics.guard_compiler import GuardCompiler
from missionkit.messages import Battery, Estimate, Verdict
from missionkit.plugin import Guard, WindowGuard
from missionkit.plugin_containment import Containment

TRUTHS = (True, False, None)
RANK = {False: 0, None: 1, True: 2}  # Kleene: and is the least, or is the greatest


class Says(Guard):
    """Returns what the test gives it."""

    kind: ClassVar[str] = "says"
    name: str = ""
    answer: Any = None

    @override
    def check(self, seen: Estimate) -> Verdict:
        if isinstance(self.answer, Exception):
            raise self.answer
        return self.answer


class Forgetful(WindowGuard):
    """Cannot advance from the third tick on."""

    kind: ClassVar[str] = "forgetful"

    @override
    def begin(self) -> int:
        return 0

    @override
    def advance(self, memory: Any, seen: Estimate) -> int:
        if memory == 2:
            raise ZeroDivisionError("no more")
        return int(memory) + 1

    @override
    def check(self, memory: Any, seen: Estimate) -> Verdict:
        return Verdict.at_least(float(memory), 2.0)


def says(answer: object, name: str = "x") -> ex.Use[Any]:
    return ex.Use("says", Says(name=name, answer=answer), NO_PLACE)


def verdicts(truths: tuple[bool | None, ...]) -> tuple[ex.Expression, ...]:
    return tuple(says(Verdict(truth), f"p{n}") for n, truth in enumerate(truths))


def asked(expression: ex.Expression, **named: ex.Expression) -> tuple[Verdict, tuple[str, ...]]:
    """Return the verdict on the first tick, and what went wrong."""
    asker, contain = GuardCompiler(named), Containment()
    ask = asker.ask(expression)
    question = GuardContext(calm(), [slot.begin() for slot in asker.slots], contain)
    for index, slot in enumerate(asker.slots):
        question.windows[index] = slot.advance(question.windows[index], question)
    return ask(question), contain.take()


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_all_any_and_not_are_kleenes(count):
    for truths in product(TRUTHS, repeat=count):
        parts = verdicts(truths)
        assert asked(ex.All(parts, NO_PLACE))[0].holds is min(truths, key=RANK.get), truths
        assert asked(ex.Any(parts, NO_PLACE))[0].holds is max(truths, key=RANK.get), truths
        negated = {True: False, False: True, None: None}[truths[0]]
        assert asked(ex.Not(parts[0], NO_PLACE))[0].holds is negated


def test_the_part_that_decides_explains_the_whole():
    near = Verdict.below(3.0, 5.0, "near")
    far = Verdict.below(7.0, 5.0, "far")
    blind = Verdict.unknown("blind")
    all_of, any_of = (
        lambda *parts, kind=kind: asked(
            kind(tuple(says(part, f"{n}") for n, part in enumerate(parts)), NO_PLACE)
        )[0]
        for kind in (ex.All, ex.Any)
    )
    assert all_of(near, blind, far) == far
    assert all_of(near, blind) == blind
    assert any_of(far, blind, near) == near
    assert any_of(far, blind) == blind
    assert any_of(far, far).holds is False


def test_not_turns_the_margin_round():
    verdict, _ = asked(ex.Not(says(Verdict.below(3.0, 5.0, "near")), NO_PLACE))
    assert verdict == Verdict(False, "near", 3.0, 5.0, -2.0)
    assert asked(ex.Not(says(Verdict.unknown("blind")), NO_PLACE))[0] == Verdict.unknown("blind")


def latched(enter: float, leave: float, charges: list[float | None]) -> list[Verdict]:
    """Return the verdicts of a latch on the battery's charge, tick by tick."""
    walk = Walk(
        "initial: x\nstates:\n"
        "  x: {kind: custom, transitions: [{to: land, after: 99, when: {hysteresis: "
        f"{{use: battery_below, floor: 0.0}}, enter: {enter}, exit: {leave}}}}}]}}\n"
        "  land: {kind: land}\n"
    )
    said = []
    for charge in charges:
        battery = None if charge is None else Battery(walk.seen().now, charge, 16.0)
        answers = walk.tick(battery=battery).answers
        said.append(answers[f"battery below (floor 0) from {enter:g} until {leave:g}"])
    return said


def test_a_latch_that_rises_holds_until_it_falls_below_its_exit():
    said = latched(0.7, 0.5, [0.6, 0.69, 0.7, 0.6, 0.5, 0.49, 0.6, 0.7])
    assert [v.holds for v in said] == [False, False, True, True, True, False, False, True]
    assert [v.threshold for v in said] == [0.7, 0.7, 0.5, 0.5, 0.5, 0.7, 0.7, 0.5]
    assert said[3].margin == pytest.approx(0.1)
    assert said[5].margin == pytest.approx(-0.21)


def test_a_latch_that_falls_holds_until_it_rises_above_its_exit():
    said = latched(0.2, 0.4, [0.5, 0.3, 0.2, 0.3, 0.4, 0.41, 0.3])
    assert [v.holds for v in said] == [False, False, True, True, True, False, False]
    assert said[3].margin == pytest.approx(0.1)
    assert said[1].margin == pytest.approx(-0.1)


def test_a_latch_without_a_value_is_unknown_and_keeps_its_side():
    said = latched(0.7, 0.5, [0.8, None, 0.6, 0.4, None, 0.6])
    assert [v.holds for v in said] == [True, None, True, False, None, False]


def test_a_latch_on_a_guard_with_memory_sees_this_ticks_memory():
    walk = Walk(
        "initial: x\nstates:\n"
        "  x:\n    kind: custom\n    dwell: 0\n    transitions:\n      - to: land\n"
        "        when: {hysteresis: {use: tally, name: a, count: 9}, enter: 3, exit: 1}\n"
        "  land: {kind: land}\n"
    )
    walk.run(1.0, "a")
    assert walk.went() == [(0.15, "land")]


TWO_STATES = """\
initial: x
dwell: 0
guards: {thrice: {use: tally, name: a, count: 3}}
states:
  x: {kind: custom, transitions: [{to: y, event: b}]}
  y: {kind: custom, transitions: [{to: x, event: c}, {to: land, when: thrice}]}
  land: {kind: land}
"""


def test_a_guards_memory_advances_while_it_is_not_evaluated():
    walk = Walk(chart_of(TWO_STATES, head="missionkit: 1\nmission: small\n"))
    for events in (("a",), ("a",), ("a",), ("b",), ()):
        walk.tick(*events)
    assert walk.went() == [(0.2, "y"), (0.2, "land")]


def test_a_named_guard_in_two_states_has_one_memory():
    text = TWO_STATES.replace("{to: y, event: b}", "{to: y, event: b}, {to: land, when: thrice}")
    chart = chart_of(text, head="missionkit: 1\nmission: small\n")
    assert [slot.name for slot in chart.slots].count("thrice") == 1
    walk = Walk(chart)
    for events in (("a",), ("a", "b"), ("a",)):
        walk.tick(*events)
    assert walk.went() == [(0.1, "y"), (0.15, "land")]


def test_guards_that_read_the_same_but_differ_are_kept_apart():
    asker = GuardCompiler({})
    first, second = (
        ex.Use("tally", Tally(name=name, count=1), NO_PLACE) for name in ("a", "a (count 1)")
    )
    near = [ex.Use("says", Says(answer=1.0 + 1e-9 * n), NO_PLACE) for n in (0, 1)]
    for expression in (first, second, *near):
        asker.ask(expression)
    assert asker.name(near[0]) == "says (answer 1)"
    assert asker.name(near[1]) == "says (answer 1) (2)"
    assert len(asker.slots) == 2


def test_a_named_guard_may_hide_the_plugin_it_is_made_of():
    named = {
        "done": ex.Not(ex.Use("done", CATALOGUE.group("guards")["done"](), NO_PLACE), NO_PLACE)
    }
    bare = ex.Use("done", CATALOGUE.group("guards")["done"](), NO_PLACE)
    both = ex.All((ex.Named("done", NO_PLACE), ex.Not(bare, NO_PLACE)), NO_PLACE)
    assert asked(both, **named)[0].holds is True
    swapped = ex.All((ex.Not(bare, NO_PLACE), ex.Named("done", NO_PLACE)), NO_PLACE)
    assert asked(swapped, **named)[0].holds is True


class Counting(Containment):
    """Counts the calls."""

    def __init__(self) -> None:
        super().__init__()
        self.calls: list[str] = []

    @override
    def call(self, name, function, *arguments, foreign=True):
        self.calls.append(name)
        return super().call(name, function, *arguments, foreign=foreign)


def test_a_guard_is_evaluated_once_per_tick():
    walk = Walk("""\
initial: x
failsafes: [{name: one, when: a, unknown: ignore, to: land}]
states:
  x:
    kind: custom
    invariant: {holds: {not: a}}
    transitions: [{to: land, when: a}, {to: land, when: {all: [a, a, b]}}]
  land: {kind: land}
""")
    walk.contain = Counting()
    walk.tick()
    assert sorted(walk.contain.calls) == ["a", "b"]


@pytest.mark.parametrize(
    ("answer", "failure"),
    [
        (ValueError("too bad"), "says raised ValueError: too bad"),
        (None, "says returned NoneType, expected a Verdict"),
        (True, "says returned bool, expected a Verdict"),
        (Verdict("yes"), "says returned a Verdict of 'yes', None"),
        (
            Verdict(np.array([True, False])),
            "says returned a Verdict of array([ True, False]), None",
        ),
        (Verdict(True, "", "high"), "says returned a Verdict of True, 'high'"),
        (Verdict(True, "", math.nan), "says returned a number that is not finite"),
        (Verdict(True, "", math.inf), "says returned a number that is not finite"),
        (Verdict(True, "", 1.0, 2.0, math.nan), "says returned a number that is not finite"),
        (Verdict(True, "", 1.0, math.nan), "says returned a number that is not finite"),
    ],
)
def test_a_foreign_guard_that_returns_nonsense_is_unknown_and_reported(answer, failure):
    verdict, failures = asked(ex.Named("says", NO_PLACE), says=says(answer))
    assert verdict.holds is None
    assert failures == (failure,)


def test_numbers_of_numpy_are_taken_for_what_they_are():
    answer = Verdict.below(np.float64(7.0), np.float32(5.0))
    assert answer.holds is not False  # numpy's own
    verdict, failures = asked(ex.All((says(answer),), NO_PLACE))
    assert verdict == Verdict(False, "", 7.0, 5.0, -2.0)
    assert verdict.holds is False
    assert failures == ()


def test_a_memory_that_cannot_advance_stays_as_it_was():
    asker, contain = GuardCompiler({}), Containment()
    ask = asker.ask(ex.Use("forgetful", Forgetful(), NO_PLACE))
    (slot,), memory, answers = asker.slots, 0, []
    for _ in range(4):
        question = GuardContext(calm(), [memory], contain)
        memory = question.windows[0] = slot.advance(memory, question)
        answers.append((ask(question).value, len(contain.take())))
    assert answers == [(1.0, 0), (2.0, 0), (2.0, 1), (2.0, 1)]
