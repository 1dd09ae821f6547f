"""Ticks that do not come to rest, as the engine finds them while the chart is explored."""

from __future__ import annotations

from collections.abc import Iterator

from missionkit.chart.checks.counterexample_text import example
from missionkit.chart.checks.exploration.example_run import run_text
from missionkit.chart.checks.exploration.exploration_result import Circle, Exploration
from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.checks.guarded_transitions import GuardedTransition, circle_text
from missionkit.chart.checks.interval_boxes import EVERYWHERE, intersection
from missionkit.errors import Level, Problem
from missionkit.messages.region import Boxes


def problems_of(chart: ExploredChart, explored: Exploration) -> Iterator[Problem]:
    """Yield circles of transitions that are all taken within one tick."""
    seen: set[int] = set()
    for circle in explored.circles:
        if seen.isdisjoint(circle.taken):
            seen.update(circle.taken)
            yield _problem(chart, circle)


def _problem(chart: ExploredChart, circle: Circle) -> Problem:
    start = circle.taken.index(min(circle.taken))
    numbers = dict.fromkeys((*circle.taken[start:], *circle.taken[:start]))
    ways = [chart.ways[each] for each in numbers]
    first = ways[0]
    held = _together(ways)
    shown = example(held)
    where = f"state {first.source!r}: {f'at {shown} ' if shown else ''}"
    run = f"; run: {run_text(chart, circle.node, circle.step, first.source)}"
    if not first.model.to:
        message = f"{first.reason} holds and leads nowhere: it fires again and again{run}"
        remedy = "wait for an 'event', or for a variable that its 'do' changes"
    else:
        does = "hold at the same time" if held else "follow each other without end"
        message = f"{circle_text(ways)} {does}: the chart loops within one tick{run}"
        remedy = "make the guards mutually exclusive, or put a 'dwell' between them"
    return Problem(first.place, f"{where}{message}", Level.ERROR, "livelock", remedy)


def _together(ways: list[GuardedTransition]) -> Boxes:
    """Return where the guards of all ways hold, as far as the world outside decides that."""
    held: Boxes = EVERYWHERE
    for way in ways:
        held = intersection(held, way.truth.may, sure=False)
    return held
