"""Visits of a flight that a campaign keeps: states, times, transitions and reasons."""

from __future__ import annotations

from collections import Counter

from missionkit.messages import Fired, Observation, Record


class VisitLog:
    """Called after every tick; a few additions each."""

    def __init__(self, period: float) -> None:
        self._period = period  # s
        self._ticks = Counter[tuple[str, ...]]()
        self._visits: list[tuple[str, int]] = []  # state, ticks
        self._problems: dict[str, None] = {}
        self._fired = Counter[tuple[str, str, str]]()  # source, to, why
        self._inside = frozenset[str]()
        self._entries = Counter[str]()

    def __call__(self, record: Record, _: Observation) -> None:
        """Take in one tick."""
        self._ticks[record.active] += 1
        again = False
        for fired in record.fired:
            self._fired[fired.source, fired.to, fired.reason] += 1
            again = again or fired.source == fired.to == record.state
        if not again and self._visits and self._visits[-1][0] == record.state:
            self._visits[-1] = (record.state, self._visits[-1][1] + 1)
        else:
            self._visits.append((record.state, 1))
        if record.fired or not self._inside:
            self._enter(record)
        if record.problems:
            self._problems |= dict.fromkeys(record.problems)

    def _enter(self, record: Record) -> None:
        """Count what was entered in a tick, what was left again in the same one included."""
        before, now = self._inside, frozenset(record.active)
        named = [(fired, to) for fired in record.fired for to in targets(fired.to)]
        passed = {fired.source for fired in record.fired} - {to for _, to in named}
        self._entries.update(now - before)
        self._entries.update(passed - before - now)
        self._entries.update(
            to for fired, to in named if to not in now or (to in before and _again(fired, record))
        )
        self._inside = now

    @property
    def visits(self) -> tuple[tuple[str, float], ...]:
        """The states that commanded, in order, and for how long (s)."""
        return tuple((state, self._seconds(ticks)) for state, ticks in self._visits)

    @property
    def times(self) -> dict[str, float]:
        """Seconds in each state that was ever active, outer ones included."""
        ticks = Counter[str]()
        for active, count in self._ticks.items():
            ticks.update(dict.fromkeys(active, count))
        return {state: self._seconds(count) for state, count in sorted(ticks.items())}

    @property
    def transitions(self) -> dict[str, int]:
        """How often each state followed another by a transition."""
        pairs = Counter[str]()
        for (source, to, _), count in self._fired.items():
            pairs[f"{source} -> {to}"] += count
        return dict(sorted(pairs.items()))

    @property
    def ways(self) -> dict[str, int]:
        """How often each transition was taken, by reason."""
        return {way(*fired): count for fired, count in sorted(self._fired.items())}

    @property
    def entries(self) -> dict[str, int]:
        """How often each state was entered, outer ones included."""
        return dict(sorted(self._entries.items()))

    @property
    def problems(self) -> tuple[str, ...]:
        """Each problem once."""
        return tuple(self._problems)

    def _seconds(self, ticks: int) -> float:
        return round(ticks * self._period, 9)


def way(source: str, to: str, reason: str) -> str:
    """Return what a row calls a transition that was taken.

    Args:
        source: name of the state that was left.
        to: name of the state that was entered.
        reason: of the transition, as the record writes it.

    >>> way("visual", "search", "when target lost for 2 s")
    'visual -> search: when target lost for 2 s'
    """
    return f"{source} -> {to}: {reason}"


def parts(name: str) -> tuple[str, str, str]:
    """Return source, target and reason of a transition from what a row calls it."""
    source, _, rest = name.partition(" -> ")
    to, _, reason = rest.partition(": ")
    return source, to, reason


def targets(to: str) -> list[str]:
    """Return the states that a transition leads to: one for each region."""
    return to.split(", ")


def _again(fired: Fired, record: Record) -> bool:
    """Say whether an active state is re-entered; transitions without a target do not count."""
    return fired.source != fired.to or fired.to == record.state
