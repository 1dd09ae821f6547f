"""The monitor against an independent evaluator that looks at whole traces."""

from __future__ import annotations

from math import inf
from random import Random

import pytest

from missionkit.chart.semantics.requirement_monitor import (
    LONGEST_QUEUE,
    MonitorMemory,
    Sample,
    standing,
    stepped,
    time_left,
)
from missionkit.chart.semantics.robustness import (
    FAILS,
    GREATEST,
    HOLDS,
    LEAST,
    UNKNOWN,
    Bounds,
    Score,
)
from missionkit.recorder import value_codec

PATTERNS = ("never", "always", "existence", "precedence", "response")


def score(pick: Random) -> Bounds:
    kind = pick.random()
    if kind < 0.15:
        return UNKNOWN
    if kind < 0.5:
        return pick.choice((HOLDS, FAILS))
    margin = round(pick.uniform(-3.0, 3.0), 1)
    one: Score = (1 if margin > 0 or (margin == 0 and pick.random() < 0.5) else -1, margin)
    return Bounds(one, one)


def minus(it: Score) -> Score:
    return (-it[0], -it[1])


def whole(pattern: str, limit: float | None, trace: list[tuple[float, Sample]], side: int) -> Score:
    """The score of a whole trace, from its definition; `side` 0 is the lower bound."""
    other = 1 - side
    begin = next((n for n, (_, it) in enumerate(trace) if it.opens[0][0] > 0), None)
    if begin is None:
        return GREATEST
    scope = trace[begin:]
    end = next((n for n, (_, it) in enumerate(scope) if it.closes[0][0] > 0), len(scope))
    scope, span = scope[:end], inf if limit is None else limit + 1e-9
    first = trace[begin][0]
    if pattern in {"never", "always", "existence"}:
        scope = [(at, it) for at, it in scope if at - first <= span]
    known = (n for n, (_, it) in enumerate(scope) if all(one[0] == one[1] for one in it[:3]))
    heard = next(known, None)
    if heard is None:
        return UNKNOWN[side]
    scope = scope[heard:]
    if pattern in {"never", "always", "existence"}:
        free = [max(minus(it.called[other]), minus(it.during[other])) for _, it in scope]
        values = [it.wanted[side] for _, it in scope]
        if pattern == "existence":
            return max((min(minus(f), v) for f, v in zip(free, values, strict=True)), default=LEAST)
        return min((max(f, v) for f, v in zip(free, values, strict=True)), default=GREATEST)
    results = []
    for at, it in scope:
        if pattern == "precedence":
            window = [s.wanted[side] for t, s in scope if at - span <= t <= at]
        else:
            window = [s.wanted[side] for t, s in scope if at <= t <= at + span]
        results.append(max(minus(it.called[other]), minus(it.during[other]), *window))
    return min(results, default=GREATEST)


def random_trace(pick: Random) -> list[tuple[float, Sample]]:
    scoped, steps = pick.random() < 0.4, pick.randint(0, 40)
    rare = lambda: HOLDS if pick.random() < 0.08 else pick.choice((FAILS, FAILS, UNKNOWN))  # noqa: E731
    return [
        (
            0.05 * n,
            Sample(
                score(pick),
                score(pick),
                HOLDS if pick.random() < 0.5 else score(pick),
                rare() if scoped else HOLDS,
                rare() if scoped else FAILS,
            ),
        )
        for n in range(steps)
    ]


@pytest.mark.parametrize("pattern", PATTERNS)
def test_a_monitor_says_in_the_end_what_the_whole_trace_says_and_before_it_never_the_contrary(
    pattern,
):
    pick = Random(pattern)  # noqa: S311
    for _ in range(300):
        limit = pick.choice((None, 0.0, 0.1, 0.5, 1.0))
        trace = random_trace(pick)
        memory, said = MonitorMemory(), [UNKNOWN]
        for at, sample in trace:
            memory = stepped(pattern, limit, memory, sample, at)
            said.append(standing(pattern, memory))
        expected = [whole(pattern, limit, trace, side) for side in (0, 1)]
        assert list(standing(pattern, memory, over=True)) == expected
        assert all(it.low <= expected[0] and expected[1] <= it.high for it in said)
        assert value_codec.read(value_codec.written(memory)) == memory


@pytest.mark.parametrize("pattern", ["precedence", "response"])
def test_a_long_window_keeps_a_bounded_queue_and_its_answer(pattern):
    memory, limit = MonitorMemory(), 100.0
    for n in range(1000):
        one: Score = (1, 2000.0 - n)
        wanted, called = (
            (Bounds(one, one), HOLDS)
            if pattern == "precedence"
            else (FAILS, Bounds(minus(one), minus(one)))
        )
        memory = stepped(pattern, limit, memory, Sample(wanted, called), 0.05 * n)
        assert max(len(memory.low.queue), len(memory.high.queue)) <= LONGEST_QUEUE
    low, high = standing(pattern, memory, over=True)
    assert low == high == (1, 1001.0) if pattern == "response" else low[0] == high[0] == 1


def test_a_countdown_runs_from_the_first_call_that_is_not_answered():
    quiet, call = Sample(FAILS, FAILS), Sample(FAILS, HOLDS)
    memory = stepped("response", 5.0, MonitorMemory(), quiet, 0.0)
    assert time_left("response", 5.0, memory, 0.0) is None
    memory = stepped("response", 5.0, memory, call, 1.0)
    memory = stepped("response", 5.0, memory, call, 2.0)
    assert time_left("response", 5.0, memory, 2.0) == 4.0
    memory = stepped("response", 5.0, memory, Sample(HOLDS, FAILS), 3.0)
    assert time_left("response", 5.0, memory, 3.0) is None
    assert standing("response", memory, over=True) == HOLDS
