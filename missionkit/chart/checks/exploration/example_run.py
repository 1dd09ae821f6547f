"""A run of a chart in words: the shortest way to where something is wrong."""

from __future__ import annotations

from collections.abc import Sequence

from missionkit.chart.checks.counterexample_text import example
from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.checks.exploration.observations import Step

STEPS_SHOWN = 6
NOT_EXCLUDED = "; this is not excluded, but no run to it was found"
START = "start"  # reason of the entry of the initial states


def steps_text(chart: ExploredChart, steps: Sequence[tuple[Step, str]]) -> str:
    """Return steps in words, each with the state that it leads to."""
    now = 0.0
    shown: list[str] = []
    for step, state in steps:
        now += step.seconds
        if step.taken or step.forced or not shown:
            cause = _cause(chart, step)
            shown.append(f"{now:g} s {cause}{': ' if cause else ''}{state}")
    return "; ".join(_shortened(shown))


def _shortened(shown: list[str]) -> list[str]:
    if len(shown) <= STEPS_SHOWN:
        return shown
    return [*shown[:2], "...", *shown[3 - STEPS_SHOWN :]]


def _cause(chart: ExploredChart, step: Step) -> str:
    if not step.taken:
        return step.forced if step.forced != START else ""
    first = step.taken[0]
    if first in chart.failsafes:
        return chart.failsafes[first]
    way = chart.ways[first]
    if way.model.event is not None:
        return f"event {' and '.join(step.events) or way.model.event[0]!r}"
    read = {quantity for box in way.truth.may for quantity in box}
    boxes = tuple({q: span for q, span in box.items() if q in read} for box in step.boxes)
    return example(boxes) or way.reason
