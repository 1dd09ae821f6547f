"""Goals and legs that leave the fence: the flight would end in a failsafe on the way."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import islice, pairwise

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.checks.planned_legs import PlannedLeg, Point3, legs
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_definitions import Failsafe
from missionkit.errors import Level, Problem
from missionkit.guards.geofence import InsideFence

Broken = Callable[[Point3], bool]  # whether the failsafe acts there
MOST_LEGS = 5_000


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield every leg on which a failsafe that depends on the place alone would act.

    And the mission's section `fence`, if no failsafe keeps it.
    """
    yield from _unkept(chart.mission)
    fences = [
        (failsafe, acts, walls)
        for failsafe in chart.mission.failsafes
        for acts, walls in _fence(failsafe, chart.mission.guards)
    ]
    if not fences:
        return
    reported: set[str] = set()  # states with several places
    for leg in islice(legs(chart), MOST_LEGS):
        if leg.state in reported:
            continue
        found = next(filter(None, (_break(leg, *fence) for fence in fences)), None)
        if found is not None:
            yield found
            reported |= {leg.state} if leg.of > 1 else set()


def _break(
    leg: PlannedLeg, failsafe: Failsafe, acts: Broken, walls: tuple[InsideFence, ...]
) -> Problem | None:
    """Return where a failsafe acts on a leg; a leg that begins there was reported before.

    That is where it is a goal, or as acting at take-off.
    """
    if acts(leg.start) and not acts(leg.end):
        return None
    at = _first_broken(leg, acts, walls)
    return None if at is None else _problem(leg, failsafe, at, acts)


def _unkept(mission: Mission) -> Iterator[Problem]:
    if mission.fence is not None and mission.fence not in walls(mission):
        yield Problem(
            mission.place("fence"),
            "no failsafe keeps the mission's fence",
            Level.WARNING,
            "unkept-fence",
            "add a failsafe such as {name: fence, when: {not: inside_fence}, to: land}",
        )


def walls(mission: Mission) -> tuple[InsideFence, ...]:
    """Return the fences at which a failsafe acts, whatever else is the case."""
    found = (
        fence
        for failsafe in mission.failsafes
        for _, fences in _fence(failsafe, mission.guards)
        for fence in fences
    )
    return tuple(dict.fromkeys(found))


def outside(mission: Mission, places: Iterable[Point3]) -> float | None:
    """Return how far (m) from its fences a failsafe acted at most, 0 if none did; None: no fence.

    Args:
        mission: whose failsafes keep fences.
        places: where the vehicle was, m, NED.
    """
    kept = [each for one in mission.failsafes for each in _fence(one, mission.guards) if each[1]]
    if not kept:
        return None
    return max(
        (
            min(abs(fence.margin(place)) for fence in fences)
            for place in places
            for acts, fences in kept
            if acts(place)
        ),
        default=0.0,
    )


def _fence(
    failsafe: Failsafe, guards: Mapping[str, ex.Expression]
) -> Iterator[tuple[Broken, tuple[InsideFence, ...]]]:
    """Yield when a failsafe acts that depends on fences only, and their walls."""
    found: list[InsideFence] = []
    waiting: list[ex.Expression] = [failsafe.when]
    while waiting:
        for part in ex.parts_of(waiting.pop()):
            if isinstance(part, ex.Named):
                waiting.append(guards[part.name])
            elif isinstance(part, ex.Use) and isinstance(part.plugin, InsideFence):
                found.append(part.plugin)
            elif not isinstance(part, ex.All | ex.Any | ex.Not):
                return
        if len(found) > 50 or len(waiting) > 200:
            return
    yield lambda point: _holds(failsafe.when, guards, point), tuple(dict.fromkeys(found))


def _holds(guard: ex.Expression, guards: Mapping[str, ex.Expression], point: Point3) -> bool:
    match guard:
        case ex.Named(name=name):
            return _holds(guards[name], guards, point)
        case ex.All(parts=parts):
            return all(_holds(part, guards, point) for part in parts)
        case ex.Any(parts=parts):
            return any(_holds(part, guards, point) for part in parts)
        case ex.Not(part=part):
            return not _holds(part, guards, point)
        case ex.Use(plugin=plugin) if isinstance(plugin, InsideFence):
            return plugin.margin(point) >= 0.0
        case _:
            return False


def _first_broken(leg: PlannedLeg, acts: Broken, walls: tuple[InsideFence, ...]) -> Point3 | None:
    """Return the first point of a leg at which a failsafe acts.

    Nothing changes between two crossings of walls, so that the crossings and one point between
    each two of them are enough.
    """
    cuts = sorted({0.0, 1.0, *(cut for wall in walls for cut in wall.cuts(leg.start, leg.end))})
    middles = [(one + other) / 2.0 for one, other in pairwise(cuts)]
    for share in sorted({*cuts, *middles}):
        point = _along(leg, share)
        if acts(point):
            return point
    return None


def _along(leg: PlannedLeg, share: float) -> Point3:
    north, east, down = (
        start + share * (end - start) for start, end in zip(leg.start, leg.end, strict=True)
    )
    return north, east, down


def _problem(leg: PlannedLeg, failsafe: Failsafe, at: Point3, acts: Broken) -> Problem:
    goal = acts(leg.end)
    if leg.of > 1:
        what = f"{'' if goal else 'the straight leg to '}place {leg.number} of {leg.of} of its way"
    else:
        what = "its goal" if goal else f"the straight leg from {leg.before or 'the start'!r}"
    where = _said(leg.end if goal else at)
    return Problem(
        leg.place,
        f"state {leg.state!r}: {what} lies where failsafe {failsafe.name!r} acts, at {where}",
        Level.ERROR,
        "outside-fence",
        "move the goal, fly round it through another state, or widen the fence",
    )


def _said(point: Point3) -> str:
    return f"[{', '.join(f'{round(value, 6) + 0.0:g}' for value in point)}]"
