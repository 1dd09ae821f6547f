"""When the battery takes a failsafe, if it goes on falling as it has lately."""

from __future__ import annotations

from collections import deque

from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.messages import Record
from missionkit.page.facts.plain_values import number
from missionkit.replays.guard_outlook import slope_of

SPAN = 60.0  # s over which the trend is taken
LEAST_SPAN = 10.0  # s; a shorter past says nothing
SAMPLE_PERIOD = 1.0  # s


class BatteryTrend:
    """Follows the charge, and extrapolates it.

    Args:
        chart: whose failsafes read it.
    """

    def __init__(self, chart: Chart) -> None:
        self._failsafes = [(it.text.removeprefix("failsafe "), it.reads) for it in chart.failsafes]
        self._past: deque[tuple[float, float]] = deque(maxlen=round(SPAN / SAMPLE_PERIOD) + 1)

    def follow(self, record: Record) -> None:
        """Take one more tick."""
        battery = record.estimate.battery
        if battery is None or (
            self._past and record.now - self._past[-1][0] < SAMPLE_PERIOD - 1e-6
        ):
            return
        self._past.append((record.now, battery.charge))

    def fall(self) -> float | None:
        """Return how much charge is lost in a second; None: that is not known."""
        if not self._past or self._past[-1][0] - self._past[0][0] < LEAST_SPAN:
            return None
        return -slope_of(self._past)

    def facts(self, record: Record) -> dict[str, object] | None:
        """Return what the page shows of the battery at a tick."""
        battery = record.estimate.battery
        if battery is None:
            return None
        fall, soonest, name = self.fall(), None, None
        answers = dict(record.verdicts)
        for failsafe, reads in self._failsafes:
            for guard in reads:
                verdict = answers.get(guard)
                if fall is None or fall <= 0.0 or verdict is None or verdict.threshold is None:
                    continue
                if verdict.value != battery.charge or battery.charge <= verdict.threshold:
                    continue
                left = (battery.charge - verdict.threshold) / fall
                if soonest is None or left < soonest:
                    soonest, name = left, failsafe
        return {
            "charge": number(battery.charge),
            "failsafe_in": None if soonest is None else round(soonest, 1),
            "failsafe": name,
            "fall": number(fall),
        }
