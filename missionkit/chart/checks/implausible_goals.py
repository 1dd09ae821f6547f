"""Places that no flight means: below the ground, or far out of any vehicle's range."""

from __future__ import annotations

import math
from collections.abc import Iterator

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.checks.planned_legs import PlannedLeg, Point3, legs
from missionkit.errors import Level, Place, Problem
from missionkit.number_text import beside

FARTHEST_GOAL = 5_000.0  # m, level, from the take-off point
HIGHEST = 500.0  # m above it
LOWEST = 0.5  # m above it, at which a vehicle that is off by as much touches the ground


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield a warning for each target and each goal that is below the ground or out of range."""
    for name, target in chart.mission.targets.items():
        yield from _problems(f"target {name!r}", target.position, target.place("position"))
    places = {target.position for target in chart.mission.targets.values()}
    reported: set[str] = set()  # states with several places
    for leg in legs(chart):
        if leg.state in reported:
            continue
        several = leg.of > 1
        goal = f"place {leg.number} of {leg.of} of its way" if several else "its goal"
        what = f"state {leg.state!r}: {goal}"
        found = list(_touching(what, leg))
        if leg.end not in places:
            found += _problems(what, leg.end, leg.place)
        if found and several:
            reported.add(leg.state)
        yield from found


def _touching(what: str, leg: PlannedLeg) -> Iterator[Problem]:
    """Yield that a vehicle which comes from above would touch the ground at its goal."""
    north, east, down = leg.end
    if -LOWEST < down <= 0.0 and leg.start[2] <= -LOWEST:
        yield Problem(
            leg.place,
            f"{what} is at [{north:g}, {east:g}, {down + 0.0:g}], {0.0 - down:g} m above the "
            "take-off point: the vehicle comes down on the ground there",
            Level.WARNING,
            "below-ground",
            "a 'height' (m), or a state of kind 'land' to land",
        )


def _problems(what: str, point: Point3, place: Place) -> Iterator[Problem]:
    north, east, down = point
    where = f"[{north:g}, {east:g}, {down:g}]"
    if down > 0.0:
        yield Problem(
            place,
            f"{what} is at {where}, {down:g} m below the take-off point: positions are "
            "[north, east, down]",
            Level.WARNING,
            "below-ground",
            f"{down:g} m above the ground is [{north:g}, {east:g}, {-down:g}]",
        )
    if math.hypot(north, east) > FARTHEST_GOAL or -down > HIGHEST:
        yield Problem(
            place,
            f"{what} is at {where}, {beside(math.hypot(north, east), FARTHEST_GOAL, 0)[0]} m away "
            f"and {beside(-down, HIGHEST, 0)[0]} m up: "
            f"more than {FARTHEST_GOAL:g} m or {HIGHEST:g} m",
            Level.WARNING,
            "out-of-range",
            "positions are metres from the take-off point, not degrees or millimetres",
        )
