"""Transitions of a flight beside those that another chart would have made of it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from enum import StrEnum
from typing import NamedTuple

from missionkit.messages import Fired
from missionkit.replays.decision_difference import same
from missionkit.replays.replayed_flight import ReplayedTick


class Change(StrEnum):
    """What became of one transition."""

    SAME = "same"
    EARLIER = "earlier"
    LATER = "later"
    NEW = "new"
    MISSING = "missing"


class Taken(NamedTuple):
    """A transition that was taken."""

    at: float  # s, mission time
    source: str
    to: str
    reason: str


class ComparedTransition(NamedTuple):
    """One transition in flight and now."""

    change: Change
    flown: Taken | None
    now: Taken | None
    evidence: bool  # until then both had flown alike: the world that was recorded is this one

    @property
    def at(self) -> float:
        """The earlier of its times (s)."""
        return min(it.at for it in (self.flown, self.now) if it is not None)


class DecisionTable(NamedTuple):
    """The transitions of a flight, compared."""

    rows: tuple[ComparedTransition, ...]  # by time
    parted: float | None  # s, first tick whose command differs; None: none does
    until: float  # s, last tick

    @property
    def first(self) -> ComparedTransition | None:
        """The first transition that is not the same, as far as the record is evidence."""
        other = (row for row in self.rows if row.change is not Change.SAME and row.evidence)
        return next(other, None)

    @property
    def differs_at(self) -> float | None:
        """First time (s) at which it decides or flies differently; None: it never does."""
        times = [] if self.first is None else [self.first.at]
        return min([*times, *([] if self.parted is None else [self.parted])], default=None)


def compared(ticks: Iterable[ReplayedTick]) -> DecisionTable:
    """Return what a replay by another mission decided, beside what was flown.

    From the first command that differs on, the vehicle would have been elsewhere: what is decided
    at later ticks rests on a world that is not the one recorded.

    Args:
        ticks: of the replay.
    """
    flown: list[Taken] = []
    now: list[Taken] = []
    parted: float | None = None
    until = 0.0
    for tick in ticks:
        until = tick.now
        flown += taken_at(tick.now, tick.flown.fired)
        now += taken_at(tick.now, tick.replayed.fired)
        if parted is None and not same(tick.flown.command, tick.replayed.command):
            parted = tick.now
    return tabulated(flown, now, parted, until)


def tabulated(
    flown: Sequence[Taken], now: Sequence[Taken], parted: float | None, until: float
) -> DecisionTable:
    """Return transitions of a flight beside those that were taken now, by time.

    Args:
        flown: transitions of the flight.
        now: those of the other mission.
        parted: s, when the first command differed; None: none did.
        until: s, the last tick.
    """
    rows = [_row(was, is_now, parted) for was, is_now in _pairs(flown, now)]
    return DecisionTable(tuple(sorted(rows, key=lambda row: row.at)), parted, until)


def taken_at(at: float, fired: Sequence[Fired]) -> list[Taken]:
    """Return the transitions of one tick (s)."""
    return [Taken(at, it.source, it.to, it.reason) for it in fired]


def _pairs(
    flown: Sequence[Taken], now: Sequence[Taken]
) -> Iterable[tuple[Taken | None, Taken | None]]:
    """Pair the n-th time a transition was taken in flight with the n-th time now."""
    before, after = _by_transition(flown), _by_transition(now)
    for key in {**before, **after}:
        old, new = before[key], after[key]
        for n in range(max(len(old), len(new))):
            yield (old[n] if n < len(old) else None, new[n] if n < len(new) else None)


def _by_transition(taken: Sequence[Taken]) -> dict[tuple[str, str], list[Taken]]:
    found: defaultdict[tuple[str, str], list[Taken]] = defaultdict(list)
    for it in taken:
        found[it.source, it.to].append(it)
    return found


def _row(flown: Taken | None, now: Taken | None, parted: float | None) -> ComparedTransition:
    if flown is None or now is None:
        change = Change.NEW if flown is None else Change.MISSING
    elif flown.at == now.at:
        change = Change.SAME
    else:
        change = Change.EARLIER if now.at < flown.at else Change.LATER
    row = ComparedTransition(change, flown, now, evidence=True)
    return row._replace(evidence=parted is None or row.at <= parted)
