"""Follows a flight tick by tick, and says what the page shows of it."""

from __future__ import annotations

from typing import Any

from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.messages import Observation, Record
from missionkit.page.facts.battery_trend import BatteryTrend
from missionkit.page.facts.chart_ids import FiredIds
from missionkit.page.facts.guard_facts import HeldGuards, needed
from missionkit.page.facts.tick_facts import Followed, fired_facts, tick_facts
from missionkit.recorder import problem_log
from missionkit.recorder.problem_log import Noted


class FlightFollower:
    """What is remembered between two ticks: following takes microseconds.

    Args:
        chart: that is flown.
    """

    def __init__(self, chart: Chart) -> None:
        self._held = HeldGuards()
        self._battery = BatteryTrend(chart)
        self._need = needed(chart)
        self._ids = FiredIds(chart)
        self._reason = ""
        self._before = 0.0
        self._problems: list[Noted] = []

    def follow(self, record: Record, tick: int) -> tuple[list[dict[str, object]], ...]:
        """Take one more tick; return its transitions, and the problems of a new kind.

        Args:
            record: of the tick.
            tick: its number.
        """
        self._held.follow(record)
        self._battery.follow(record)
        fired = [fired_facts(it, record.now, tick, self._ids) for it in record.fired]
        if record.fired:
            self._reason = record.fired[-1].reason
        new = problem_log.note(self._problems, record.problems, record.now, self._before)
        self._before = record.now
        return fired, [{"at": it.at, "says": it.says, "times": it.times} for it in new]

    def followed(self, tick: int, record: Record) -> Followed:
        """Return what is remembered.

        Args:
            tick: number of the tick that was followed last.
            record: of that tick.
        """
        battery = self._battery.facts(record)
        return Followed(tick, self._reason, self._held.since, self._need, battery)

    def facts(self, record: Record, seen: Observation, tick: int) -> dict[str, Any]:
        """Return what the page shows of the tick that was followed last.

        Args:
            record: of the tick.
            seen: its observation.
            tick: its number.
        """
        return tick_facts(record, seen, self.followed(tick, record))
