"""What a campaign keeps of a flight: which states, for how long, by which transitions."""

from __future__ import annotations

from collections import Counter

from missionkit.messages import Observation, Record


class Diary:
    """Called after every tick; a few additions each."""

    def __init__(self, period: float) -> None:
        self._period = period  # s
        self._ticks = Counter[tuple[str, ...]]()
        self._visits: list[tuple[str, int]] = []  # state, ticks
        self._problems: dict[str, None] = {}
        self._fired = Counter[str]()

    def __call__(self, record: Record, _: Observation) -> None:
        """Take in one tick."""
        self._ticks[record.active] += 1
        again = False
        for fired in record.fired:
            self._fired[f"{fired.source} -> {fired.to}"] += 1
            again = again or fired.source == fired.to == record.state
        if not again and self._visits and self._visits[-1][0] == record.state:
            self._visits[-1] = (record.state, self._visits[-1][1] + 1)
        else:
            self._visits.append((record.state, 1))
        if record.problems:
            self._problems |= dict.fromkeys(record.problems)

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
        """How often each transition was taken."""
        return dict(sorted(self._fired.items()))

    @property
    def problems(self) -> tuple[str, ...]:
        """Each problem once."""
        return tuple(self._problems)

    def _seconds(self, ticks: int) -> float:
        return round(ticks * self._period, 9)
