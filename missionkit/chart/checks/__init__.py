"""Proof before flight: what is wrong with a mission that is well written."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from missionkit.chart.checks import (
    battery_reserve,
    broken_on_entry,
    broken_requirements,
    control_gains,
    default_failsafes,
    delayed_events,
    disarming,
    event_deadlocks,
    geofence_violations,
    hysteresis,
    implausible_goals,
    landing_guarantee,
    livelocks,
    markers_in_view,
    misspelt_events,
    never_fires,
    oscillations,
    parallel_conflicts,
    payload_devices,
    plugin_requirements,
    reachability,
    shadowed_transitions,
    standoffs,
    stopping_distance,
    success_conditions,
    take_off_failsafes,
    unused_parameters,
)
from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.checks.exploration.search import explore
from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_contracts import fulfilled
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.errors import Level, Problem

CHECKS: tuple[Callable[[AnalysedChart], Iterator[Problem]], ...] = (
    shadowed_transitions.problems_of,
    shadowed_transitions.failsafes,
    parallel_conflicts.overlaps,
    reachability.traps,
    oscillations.problems_of,
    delayed_events.problems_of,
    hysteresis.problems_of,
    broken_on_entry.problems_of,
    plugin_requirements.problems_of,
    payload_devices.problems_of,
    landing_guarantee.problems_of,
    landing_guarantee.returns,
    misspelt_events.problems_of,
    event_deadlocks.problems_of,
    geofence_violations.problems_of,
    standoffs.problems_of,
    markers_in_view.problems_of,
    markers_in_view.dark_landings,
    control_gains.problems_of,
    success_conditions.problems_of,
    unused_parameters.problems_of,
)
NEVER_FIRES = frozenset(("never-true", "shadowed-transition", "contradictory-timers"))


def findings(
    mission: Mission,
    catalogue: Catalogue,
    *,
    endurance: float | None = None,
    charge: float = 1.0,
    sight: float | None = None,
) -> list[Problem]:
    """Return everything that the checks find, in the order of the file.

    Args:
        mission: as loaded without problems; its contracts are carried out here.
        catalogue: what it was loaded with.
        endurance: time (s) that the vehicle hovers on a full battery, if that is known.
        charge: of the battery at the start, 0 to 1.
        sight: how far (m) the scanner sees obstacles, if that is known.
    """
    catalogue = catalogue.flying(mission.vehicle.use)
    chart = AnalysedChart(fulfilled(mission, catalogue), catalogue)
    found = [problem for check in CHECKS for problem in check(chart)]
    found += _explored(chart, found)
    if catalogue.vehicle.over_ground:
        found += implausible_goals.problems_of(chart)
        found += take_off_failsafes.problems_of(chart, charge)
    found += default_failsafes.problems_of(mission, catalogue)
    if endurance is not None:
        found += battery_reserve.problems_of(chart, endurance)
    if sight is not None:
        found += stopping_distance.problems_of(chart, sight)
    return sorted(_told_once(found), key=_order)


def _explored(chart: AnalysedChart, reported: Iterable[Problem]) -> Iterator[Problem]:
    """Yield what the exploration of the chart finds besides what is known already."""
    explored_chart = ExploredChart(chart)
    explored = explore(explored_chart)
    if not explored.complete:
        yield _unproven(chart)
    yield from livelocks.problems_of(explored_chart, explored)
    yield from disarming.problems_of(explored_chart, explored)
    yield from broken_requirements.problems_of(explored_chart, explored)
    yield from reachability.unreachable(chart, explored)
    places = {problem.place for problem in reported if problem.code in NEVER_FIRES}
    yield from never_fires.problems_of(explored_chart, explored, places)


def _unproven(chart: AnalysedChart) -> Problem:
    return Problem(
        chart.mission.place("states"),
        "the chart can do more than was explored: it is not proven that every transition can fire "
        "and that no tick goes on without end",
        Level.WARNING,
        "unproven",
        "use fewer parallel regions, or fewer values of variables",
    )


def _told_once(problems: Iterable[Problem]) -> Iterator[Problem]:
    """Yield each problem once, of all instances where several have it of a file they include."""
    same: dict[Problem, list[Problem]] = {}
    for problem in problems:
        same.setdefault(problem, []).append(problem)
    for first, *others in same.values():
        if any(other.place.inside != first.place.inside for other in others):
            yield replace(first, place=replace(first.place, inside=""))
        else:
            yield first


def _order(problem: Problem) -> tuple[str, int, int, str, str]:
    place = problem.place
    return place.file, place.line, place.column, problem.code, problem.message
