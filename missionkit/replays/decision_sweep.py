"""Where the decisions of a flight change as one parameter grows, by bisection.

A decision is compared by what it is, not by when: whether the first transition that differs comes
earlier, is new, or is not taken at its time, and which it is. The flight is asked at evenly spaced
values, and between two that decide differently the step is halved. A decision that comes and goes
between two neighbours is not seen.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from missionkit.messages import Fired
from missionkit.replays.chart_replay import ways
from missionkit.replays.decision_difference import same
from missionkit.replays.decision_table import Change
from missionkit.replays.replayed_flight import ReplayedTick

SPLITS = 8  # of the range, before bisection
KNOWN_TO = 1e-3  # of the range
AS_FLOWN = "as flown"
FLIES = "another command, the same transitions until then"


class DecisionAt(NamedTuple):
    """The first thing that differs at one value of a parameter.

    Attributes:
        says: what, without its time; `AS_FLOWN`: nothing.
        at: s, mission time; None: nothing differs.
    """

    says: str
    at: float | None = None


class SweptPart(NamedTuple):
    """A part of the range in which a flight decides the same.

    Attributes:
        low: its first value.
        high: its last one; the next part begins within a thousandth of the range.
        says: what differs first, in words.
        first: s, mission time of that at `low`.
        last: s, mission time of that at `high`.
    """

    low: float
    high: float
    says: str
    first: float | None
    last: float | None


Decide = Callable[[float], DecisionAt]


class _Point(NamedTuple):
    value: float
    decision: DecisionAt

    def agrees(self, other: _Point) -> bool:
        return self.decision.says == other.decision.says


def swept(decide: Decide, low: float, high: float, *, whole: bool = False) -> list[SweptPart]:
    """Return the parts of a range in which a flight decides the same.

    Args:
        decide: gives what differs first at a value.
        low: begin of the range.
        high: its end.
        whole: the parameter counts something.
    """

    def point(value: float) -> _Point:
        return _Point(value, decide(value))

    near = 1.0 if whole else KNOWN_TO * (high - low)
    values = [low + (high - low) * n / SPLITS for n in range(SPLITS + 1)]
    if whole:
        values = sorted({float(round(value)) for value in values})
    parts: list[list[_Point]] = [[point(values[0])]]
    for value in values[1:]:
        _extend(parts, point(value), point, near)
    return [_part(part) for part in parts]


def _extend(
    parts: list[list[_Point]], end: _Point, point: Callable[[float], _Point], near: float
) -> None:
    """Add a point to the parts, with those that it takes to know where the decision changes."""
    while not end.agrees(parts[-1][-1]):
        before, after = parts[-1][-1], end
        while after.value - before.value > near * (1.0 + 1e-9):
            middle = (before.value + after.value) / 2
            between = point(float(round(middle)) if near == 1.0 else middle)
            if between.agrees(before):
                before = between
            else:
                after = between
        parts[-1].append(before)
        parts.append([after])
    parts[-1].append(end)


def _part(points: Sequence[_Point]) -> SweptPart:
    first, last = points[0], points[-1]
    says, at = first.decision
    return SweptPart(first.value, last.value, says, at, last.decision.at)


def decision_at(ticks: Iterable[ReplayedTick], flown: Sequence[Fired]) -> DecisionAt:
    """Return what differs first in a replay.

    Args:
        ticks: of the replay; no more are taken than needed.
        flown: every transition of the flight.
    """
    for tick in ticks:
        says = difference(tick.replayed.fired, tick.flown.fired, flown)
        if says:
            return DecisionAt(says, tick.now)
        if not same(tick.flown.command, tick.replayed.command):
            return DecisionAt(FLIES, tick.now)
    return DecisionAt(AS_FLOWN)


def difference(now: Sequence[Fired], then: Sequence[Fired], flown: Sequence[Fired]) -> str:
    """Return in what the transitions of one tick differ, in words; "": in nothing.

    Args:
        now: with the other value.
        then: in flight.
        flown: every transition of the flight.
    """
    if ways(now) == ways(then):
        return ""
    if now:
        change = Change.EARLIER if set(ways(now)) <= set(ways(flown)) else Change.NEW
        return f"{_text(now)} {change}"
    return f"{_text(then)} {Change.LATER} or {Change.MISSING}"


def _text(fired: Sequence[Fired]) -> str:
    return ", ".join(f"{it.source} -> {it.to}" for it in fired)
