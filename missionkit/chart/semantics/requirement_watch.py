"""The requirements of a chart, watched at the end of every tick and shown like guards."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import NamedTuple

from missionkit.chart.model.requirements import Pattern
from missionkit.chart.semantics.requirement_monitor import (
    MonitorMemory,
    Sample,
    standing,
    stepped,
    time_left,
)
from missionkit.chart.semantics.robustness import (
    FAILS,
    HOLDS,
    UNKNOWN,
    Answers,
    Bounds,
    Formula,
    contrary,
)
from missionkit.chart.semantics.time_tolerance import EPSILON
from missionkit.messages import Verdict

PREFIX = "requirement "
UNOBSERVED = Sample(UNKNOWN, UNKNOWN, UNKNOWN, UNKNOWN, UNKNOWN)
STANDINGS: Mapping[bool | None, str] = {True: "fulfilled", False: "broken", None: "open"}


@dataclass(frozen=True, slots=True)
class WatchedRequirement:
    """A requirement, compiled."""

    name: str
    label: str  # what the record calls it
    pattern: Pattern
    limit: float | None  # s
    wanted: Formula
    called: Formula | None = None
    during: Formula | None = None
    opens: Formula | None = None
    closes: Formula | None = None
    to: str | None = None  # where it leads when it is broken
    tolerated: float = 0.0  # s it may be broken

    @property
    def reason(self) -> str:
        """Why it leads away."""
        return f"{self.label} broken for {self.tolerated:g} s"


def watched(
    each: WatchedRequirement, memory: MonitorMemory, answers: Answers, now: float
) -> MonitorMemory:
    """Return the memory of a requirement after one more tick.

    Args:
        each: the requirement.
        memory: before.
        answers: of the guards in it, at the end of the tick.
        now: s.
    """
    if memory.closed:
        return memory
    sample = _sample(each, answers)
    following = stepped(each.pattern, each.limit, memory, sample, now)
    if each.to is None or (following.opened is None and memory.opened is None):
        return following
    known = following.broken_since is not None
    if _broken(each, following, sample):
        return following if known else following._replace(broken_since=now)
    if known or following.acted:
        return following._replace(broken_since=None, acted=False)
    return following


def across_gap(each: WatchedRequirement, memory: MonitorMemory, now: float) -> MonitorMemory:
    """Return the memory of a requirement after a time in which nothing was observed.

    Args:
        each: the requirement.
        memory: before.
        now: s, the end of that time.
    """
    return stepped(each.pattern, each.limit, memory, UNOBSERVED, now)


def _sample(each: WatchedRequirement, answers: Answers) -> Sample:
    wanted = each.wanted(answers)
    return Sample(
        contrary(wanted) if each.pattern == "never" else wanted,
        HOLDS if each.called is None else each.called(answers),
        HOLDS if each.during is None else each.during(answers),
        HOLDS if each.opens is None else each.opens(answers),
        FAILS if each.closes is None else each.closes(answers),
    )


def _broken(each: WatchedRequirement, memory: MonitorMemory, sample: Sample) -> bool:
    """Say whether a requirement is broken now; what must hold all the time may be whole again."""
    if each.pattern in {"never", "always"}:
        failing = sample.wanted.high[0] < 0 and sample.during.low[0] > 0
        return failing and not memory.closed
    return standing(each.pattern, memory).high[0] < 0


def overdue(each: WatchedRequirement, memory: MonitorMemory, now: float) -> bool:
    """Say whether a requirement has been broken for as long as it may be, and has not led away.

    Args:
        each: the requirement.
        memory: of its monitor, after the last tick.
        now: s.
    """
    since = memory.broken_since
    waiting = each.to is not None and since is not None and not memory.acted
    return waiting and since is not None and now - since >= each.tolerated - EPSILON


def verdict(each: WatchedRequirement, memory: MonitorMemory, now: float) -> Verdict:
    """Return what the record shows of a requirement: its standing, robustness and countdown.

    The value is the robustness as far as it is known, in the unit of the guard that decides.

    Args:
        each: the requirement.
        memory: of its monitor, after this tick.
        now: s.
    """
    bounds = standing(each.pattern, memory)
    holds = truth(bounds)
    why = STANDINGS[holds]
    if holds is None and each.limit is not None:
        left = time_left(each.pattern, each.limit, memory, now)
        why = why if left is None else f"open, {left:.1f} s left"
    if memory.broken_since is not None and each.to is not None and not memory.acted:
        more = max(0.0, memory.broken_since + each.tolerated - now)
        why = f"{why}, leads to {each.to} in {more:.1f} s"
    margin = margin_of(bounds)
    return Verdict(holds, why, margin, None if margin is None else 0.0, margin)


class RequirementResult(NamedTuple):
    """What came of a requirement."""

    name: str
    fulfilled: bool | None  # None: undecided
    robustness: float | None  # in the unit of the guard that decides; None: no number decides

    @property
    def figure(self) -> str:
        """Its robustness in words."""
        return "" if self.robustness is None else f"robustness {self.robustness:.3g}"


def results(
    requirements: Iterable[WatchedRequirement],
    monitors: Iterable[MonitorMemory],
    *,
    over: bool = True,
) -> tuple[RequirementResult, ...]:
    """Return what came of each requirement.

    Args:
        requirements: of the chart.
        monitors: at the end, in the same order.
        over: the run has ended: what has not happened will not.
    """
    ends = (
        (each, standing(each.pattern, monitor, over=over))
        for each, monitor in zip(requirements, monitors, strict=True)
    )
    return tuple(RequirementResult(it.name, truth(end), margin_of(end)) for it, end in ends)


def truth(bounds: Bounds) -> bool | None:
    """Return whether a requirement is fulfilled; None: open."""
    if bounds.low[0] > 0:
        return True
    return False if bounds.high[0] < 0 else None


def margin_of(bounds: Bounds) -> float | None:
    """Return the robustness that is known: the least so far, or the greatest of what must be."""
    low, high = bounds
    if isfinite(high[1]):
        return high[1]
    return low[1] if isfinite(low[1]) else None
