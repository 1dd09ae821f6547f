"""The chart of a flight alone, asked again with the estimates of a replay.

Navigation, vision and behaviours cost nearly all of a replay, and until a transition differs they
do the same whatever the numbers in the guards: what the chart was asked with is kept once, and
other numbers are then tried in milliseconds. From the first transition that differs on, the
estimates are not those that the other chart would have seen: there a trial ends.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from missionkit.chart.semantics.chart_memory import ChartMemory, begin
from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.chart.semantics.quick_step import decide
from missionkit.engine import pause
from missionkit.messages import Estimate, Fired
from missionkit.plugin_containment import Containment
from missionkit.replays.replayed_flight import ReplayedTick


class ChartTick(NamedTuple):
    """What the chart was asked with at one tick, and what it did."""

    number: int
    now: float  # s, mission time
    seen: Estimate
    stopped: float  # s by which its clocks were put off: a pause
    fired: tuple[Fired, ...]
    before: ChartMemory  # of the chart that flew, before the tick


class FirstDifference(NamedTuple):
    """The first tick at which another chart takes other transitions."""

    number: int
    now: float  # s
    fired: tuple[Fired, ...]  # by the other chart
    flown: tuple[Fired, ...]


def chart_ticks(chart: Chart, ticks: Iterable[ReplayedTick]) -> Iterator[ChartTick]:
    """Yield what the chart was asked with in a replay by the plan that flew.

    Args:
        chart: that flew.
        ticks: of the replay, from the start of the mission.
    """
    before = begin(chart, 0.0)
    for it in ticks:
        yield ChartTick(it.number, it.now, it.seen, it.stopped, it.replayed.fired, before)
        before = it.memory.chart


def first_difference(
    chart: Chart, ticks: Sequence[ChartTick], start: int = 0
) -> FirstDifference | None:
    """Return where another chart first takes other transitions than were flown; None: nowhere.

    Args:
        chart: with the states and behaviours of the one that flew.
        ticks: from the start of the mission.
        start: index of the tick before which the chart cannot have differed.
    """
    memory, contain = begin(chart, 0.0), Containment()
    if start < len(ticks) and len(ticks[start].before.windows) == len(memory.windows):
        memory, ticks = ticks[start].before, ticks[start:]
    for tick in ticks:
        memory, fired = _asked(chart, memory, tick, contain)
        if fired != tick.fired and ways(fired) != ways(tick.fired):
            return FirstDifference(tick.number, tick.now, fired, tick.fired)
    return None


def ways(fired: Sequence[Fired]) -> tuple[tuple[str, str], ...]:
    """Return where transitions led from and to: their reasons name numbers that were changed."""
    return tuple((it.source, it.to) for it in fired)


def _asked(
    chart: Chart, memory: ChartMemory, tick: ChartTick, contain: Containment
) -> tuple[ChartMemory, tuple[Fired, ...]]:
    if tick.stopped:
        memory = pause.stopped(memory, tick.stopped)
    memory, decision = decide(chart, memory, tick.seen, contain)
    contain.failures.clear()
    return memory, decision.fired
