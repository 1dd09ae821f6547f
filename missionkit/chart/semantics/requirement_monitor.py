"""Monitor of one requirement: a pure step per tick, constant work amortised, bounded memory.

Each pattern is a minimum over what it demands, of scores (`robustness`), between two bounds:

    never p        min over t of -p(t)
    always p       min over t of p(t)
    existence s    max over t of s(t)
    precedence s   min over t of max(-p(t), max of s over [t - T, t])
    response       min over t of max(-p(t), max of s over [t, t + T])

The maxima over windows are sliding extrema with a monotonic queue. Of a response, only demands
that may still become the least are kept: of two, the later one matters only while it is the worse.

Source: D. Lemire, "Streaming maximum-minimum filter using no more than three comparisons per
element", Nordic Journal of Computing 13, 2006.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

from missionkit.chart.model.requirements import Pattern
from missionkit.chart.semantics.robustness import (
    GREATEST,
    HOLDS,
    LEAST,
    UNKNOWN,
    Bounds,
    Score,
    negated,
)
from missionkit.chart.semantics.time_tolerance import EPSILON

LONGEST_QUEUE = 256  # scores kept of a window; beyond, neighbours of equal answer are joined
Queue = tuple[tuple[float, Score], ...]  # time (s) and score, the oldest first


class Sample(NamedTuple):
    """What a requirement is made of, at one tick."""

    wanted: Bounds  # what must hold, happen, have happened or follow; of `never`: the contrary
    called: Bounds = HOLDS  # what calls for it: `when`, or what it must come before
    during: Bounds = HOLDS  # while
    opens: Bounds = HOLDS  # after
    closes: Bounds = Bounds(LEAST, LEAST)  # before; not of a precedence


class Side(NamedTuple):
    """One of the two bounds."""

    worst: Score = GREATEST  # of the demands that are settled
    best: Score = LEAST  # of what must happen, so far
    queue: Queue = ()  # precedence: of what has happened; response: demands not settled


UNTOUCHED = Side()


class MonitorMemory(NamedTuple):
    """How far a requirement has come. Immutable, and fit to be saved."""

    opened: float | None = None  # s, since when it counts
    heard: bool = False  # all its guards have answered since; nothing counts before
    closed: bool = False  # it no longer counts
    low: Side = UNTOUCHED
    high: Side = UNTOUCHED  # the same as `low` while nothing was unknown
    broken_since: float | None = None  # s
    acted: bool = False  # it has led away since it is broken


def stepped(
    pattern: Pattern, limit: float | None, memory: MonitorMemory, sample: Sample, now: float
) -> MonitorMemory:
    """Return the memory after one more tick.

    Args:
        pattern: of the requirement.
        limit: its time bound, s; None: none.
        memory: before.
        sample: at this tick.
        now: s.
    """
    if memory.closed:
        return memory
    opened = memory.opened
    if opened is None:
        if sample.opens.low[0] < 0:
            return memory
        opened = now
    late = limit is not None and pattern in _TIMED and now - opened > limit + EPSILON
    if late or sample.closes.low[0] > 0:
        return memory._replace(opened=opened, closed=True)
    wanted, called, during, _, _ = sample
    if not memory.heard and not (wanted.known and called.known and during.known):
        return memory._replace(opened=opened)
    step, span = _STEPS[pattern], inf if limit is None else limit
    free = max(negated(called.high), negated(during.high))
    low = step(memory.low, free, wanted.low, now, span)
    if memory.low is memory.high and called.known and during.known and wanted.known:
        high = low
    else:
        free = max(negated(called.low), negated(during.low))
        high = step(memory.high, free, wanted.high, now, span)
    if low is memory.low and high is memory.high and memory.heard:
        return memory
    return memory._replace(opened=opened, heard=True, low=low, high=high)


_TIMED = frozenset(("never", "always", "existence"))


def _always(side: Side, free: Score, wanted: Score, _now: float, _span: float) -> Side:
    score = max(free, wanted)
    return side if score >= side.worst else side._replace(worst=score)


def _existence(side: Side, free: Score, wanted: Score, _now: float, _span: float) -> Side:
    score = min(negated(free), wanted)
    return side if score <= side.best else side._replace(best=score)


def _precedence(side: Side, free: Score, wanted: Score, now: float, span: float) -> Side:
    worst, best, queue = side
    if span == inf:
        best = found = max(best, wanted)
    elif queue or wanted > LEAST:
        first, end = 0, len(queue)
        while first < end and queue[first][0] < now - span - EPSILON:
            first += 1
        while end > first and queue[end - 1][1] <= wanted:
            end -= 1
        queue = _shortened((*queue[first:end], (now, wanted)), keep=1)
        found = queue[0][1]
    else:
        found = LEAST
    score = max(free, found)
    if score >= worst and best is side.best and queue is side.queue:
        return side
    return Side(min(worst, score), best, queue)


def _response(side: Side, free: Score, wanted: Score, now: float, span: float) -> Side:
    worst, best, queue = side
    gone = 0
    while gone < len(queue) and queue[gone][0] + span < now - EPSILON:
        worst = min(worst, queue[gone][1])
        gone += 1
    queue = queue[gone:] if gone else queue
    end = len(queue)
    while end and queue[end - 1][1] <= wanted:
        end -= 1
    if end < len(queue):  # the earliest of those that are answered now stands for all
        queue = (*queue[:end], (queue[end][0], wanted))
    score = max(free, wanted)
    if score < (queue[-1][1] if queue else GREATEST):
        queue = _shortened((*queue, (now, score)), keep=0)
    return side if queue is side.queue and worst is side.worst else Side(worst, best, queue)


_STEPS = {
    "never": _always,
    "always": _always,
    "existence": _existence,
    "precedence": _precedence,
    "response": _response,
}


def _shortened(queue: Queue, *, keep: int) -> Queue:
    """Join two neighbours of a queue that is too long: the answer stays, the margin is bounded.

    Args:
        queue: of scores that fall.
        keep: whose time stands for both: 0 the earlier's, 1 the later's; the lesser score does.
    """
    if len(queue) <= LONGEST_QUEUE:
        return queue
    at = next(n for n in range(len(queue) - 1) if queue[n][1][0] == queue[n + 1][1][0])
    joined = (queue[at + keep][0], queue[at + 1][1])
    return (*queue[:at], joined, *queue[at + 2 :])


def standing(pattern: Pattern, memory: MonitorMemory, *, over: bool = False) -> Bounds:
    """Return the requirement's score as far as it is known.

    Args:
        pattern: of the requirement.
        memory: of its monitor.
        over: the run has ended: what has not happened will not.
    """
    if memory.opened is None:
        return HOLDS if over else UNKNOWN
    if not memory.heard:
        return UNKNOWN
    settled = over or memory.closed
    low = _settled(pattern, memory.low) if settled else LEAST
    high = _settled(pattern, memory.high) if settled else GREATEST
    if settled:
        return Bounds(low, high)
    if pattern == "existence":
        return Bounds(memory.low.best, GREATEST)
    return Bounds(LEAST, memory.high.worst)


def _settled(pattern: Pattern, side: Side) -> Score:
    if pattern == "existence":
        return side.best
    if pattern == "response" and side.queue:
        return min(side.worst, side.queue[-1][1])
    return side.worst


def time_left(
    pattern: Pattern, limit: float | None, memory: MonitorMemory, now: float
) -> float | None:
    """Return the time (s) until the bound decides; None if nothing is waited for.

    Args:
        pattern: of the requirement.
        limit: its time bound, s; None: none.
        memory: of its monitor.
        now: s.
    """
    if limit is None or memory.closed or memory.opened is None or pattern == "precedence":
        return None
    if pattern != "response":
        return max(0.0, memory.opened + limit - now)
    due = next((at for at, score in memory.high.queue if score[0] < 0), None)
    return None if due is None else max(0.0, due + limit - now)
