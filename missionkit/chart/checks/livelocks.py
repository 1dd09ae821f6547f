"""Ticks that do not come to rest, as the engine finds them while the chart is explored."""

from __future__ import annotations

from collections.abc import Iterator

from missionkit.chart.checks.counterexample_text import example
from missionkit.chart.checks.exploration.concrete_flight import Run
from missionkit.chart.checks.exploration.concrete_run import Concrete
from missionkit.chart.checks.exploration.example_run import NOT_EXCLUDED, steps_text
from missionkit.chart.checks.exploration.exploration_result import Circle, Exploration
from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.checks.exploration.observations import Step
from missionkit.chart.checks.guarded_transitions import GuardedTransition, circle_text
from missionkit.chart.checks.interval_boxes import EVERYWHERE, intersection
from missionkit.errors import Level, Problem
from missionkit.messages.region import Boxes


def problems_of(chart: ExploredChart, explored: Exploration) -> Iterator[Problem]:
    """Yield circles of transitions that are all taken within one tick."""
    seen: set[int] = set()
    concrete = Concrete(chart, explored)
    for circle in explored.circles:
        if seen.isdisjoint(circle.taken):
            seen.update(circle.taken)
            yield _problem(chart, circle, flown_into(circle, concrete))


def flown_into(circle: Circle, concrete: Concrete) -> Run | None:
    """Return a flight into a circle of the same transitions as another, None if none was found."""
    goals: dict[int, list[Step]] = {}
    for each in concrete.explored.circles:
        if set(each.taken) == set(circle.taken):
            goals.setdefault(each.node.number, []).append(each.step)
    return concrete.run(goals, lambda tried: tried.restless)


def _problem(chart: ExploredChart, circle: Circle, flown: Run | None) -> Problem:
    start = circle.taken.index(min(circle.taken))
    numbers = dict.fromkeys((*circle.taken[start:], *circle.taken[:start]))
    ways = [chart.ways[each] for each in numbers]
    first = ways[0]
    held = _together(ways)
    shown = example(held)
    where = f"state {first.source!r}: {f'at {shown} ' if shown else ''}"
    run = NOT_EXCLUDED
    if flown is not None:  # the engine undoes the tick: the run ends where that begins
        last = (flown.steps[-1][0], first.source)
        run = f"; run: {steps_text(chart, (*flown.steps[:-1], last))}"
    if not first.model.to:
        message = f"{first.reason} holds and leads nowhere: it fires again and again{run}"
        remedy = "wait for an 'event', or for a variable that its 'do' changes"
    else:
        does = "hold at the same time" if held else "follow each other without end"
        message = f"{circle_text(ways)} {does}: the chart loops within one tick{run}"
        remedy = "make the guards mutually exclusive, or put a 'dwell' between them"
    level = Level.WARNING if flown is None else Level.ERROR
    return Problem(first.place, f"{where}{message}", level, "livelock", remedy)


def _together(ways: list[GuardedTransition]) -> Boxes:
    """Return where the guards of all ways hold, as far as the world outside decides that."""
    held: Boxes = EVERYWHERE
    for way in ways:
        held = intersection(held, way.truth.may, sure=False)
    return held
