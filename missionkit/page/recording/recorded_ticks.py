"""Any tick of a recorded flight, computed again from the nearest memory before it."""

from __future__ import annotations

import bisect
from collections.abc import Iterator
from typing import NamedTuple

from missionkit.engine.prepared_mission import PreparedMission
from missionkit.messages import Observation, Record
from missionkit.page.facts.flight_follower import FlightFollower
from missionkit.recorder.journal_reader import Journal
from missionkit.replays.replayed_flight import ReplayedTick, replayed, start_at

REPLAYED_AT_ONCE = 20.0  # s; what is further ahead begins at a later memory
WARM_UP = 1.0  # s replayed before what is shown: how long guards have held by then


class ShownTick(NamedTuple):
    """A tick as it was flown."""

    number: int
    record: Record
    observation: Observation


class RecordedTicks:
    """The ticks of a flight, in any order; one after the other is quick.

    Args:
        plan: that flew.
        journals: in the order they were flown.
    """

    def __init__(self, plan: PreparedMission, journals: tuple[Journal, ...]) -> None:
        self._plan = plan
        self._journals = [it for it in journals if it.ticks]
        self._begin = [it.ticks[0][0] for it in self._journals]
        self.times = [at for it in self._journals for at, _ in it.ticks]  # s
        self._ticks: Iterator[ReplayedTick] = iter(())
        self._part = -1
        self._shown: ShownTick | None = None
        self.follower = FlightFollower(plan.chart)

    def number_at(self, at: float) -> int:
        """Return the number of the last tick that is not later than a time (s)."""
        return max(0, bisect.bisect_right(self.times, at + 1e-6) - 1)

    def tick(self, number: int) -> ShownTick | None:
        """Return a tick; None if the flight has none.

        Raises:
            UsageError: the journal was changed, or cannot be replayed from there.
        """
        if not self.times:
            return None
        at = self.times[min(number, len(self.times) - 1)]
        shown = self._shown
        if shown is None or not shown.record.now <= at <= shown.record.now + REPLAYED_AT_ONCE:
            self._restart(at)
        while self._shown is None or self._shown.record.now < at - 1e-9:
            if not self._advance():
                break
        return self._shown

    def _restart(self, at: float) -> None:
        """Begin at the nearest memory before a time (s)."""
        self._part = max(0, bisect.bisect_right(self._begin, at + 1e-9) - 1)
        journal = self._journals[self._part]
        self._ticks = replayed(self._plan, journal, start_at(self._plan, journal, at - WARM_UP))
        self._shown = None
        self.follower = FlightFollower(self._plan.chart)

    def _advance(self) -> bool:
        done = next(self._ticks, None)
        if done is None:
            return self._next_part()
        flown = done.record._replace(**done.flown._asdict())
        number = bisect.bisect_left(self.times, done.now - 1e-9)
        self._shown = ShownTick(number, flown, done.observation)
        self.follower.follow(flown, number)
        return True

    def _next_part(self) -> bool:
        if self._part + 1 >= len(self._journals):
            return False
        self._part += 1
        journal = self._journals[self._part]
        self._ticks = replayed(self._plan, journal, start_at(self._plan, journal, 0.0))
        return self._advance()
