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
    """Yield every leg on which a failsafe that depends on the place alone would act."""
    fences = [
        (failsafe, acts, walls)
        for failsafe in chart.mission.failsafes
        for acts, walls in _fence(failsafe, chart.mission.guards)
    ]
    if not fences:
        return
    told: set[str] = set()  # states with several places
    for leg in islice(legs(chart), MOST_LEGS):
        if leg.state in told:
            continue
        found = next(filter(None, (_break(leg, *fence) for fence in fences)), None)
        if found is not None:
            yield found
            told |= {leg.state} if leg.of > 1 else set()


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
            min(abs(margin(fence, place)) for fence in fences)
            for place in places
            for acts, fences in kept
            if acts(place)
        ),
        default=0.0,
    )


def margin(fence: InsideFence, place: Point3) -> float:
    """Return the distance (m) of a place to the nearest wall or the ceiling, negative outside."""
    north, east, down = place
    level = (north - fence.north[0], fence.north[1] - north, east - fence.east[0])
    return min(*level, fence.east[1] - east, fence.height + down)


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
            return inside(plugin, point)
        case _:
            return False


def inside(fence: InsideFence, point: Point3) -> bool:
    """Say whether a point is inside a fence, walls included."""
    north, east, down = point
    level = fence.north[0] <= north <= fence.north[1] and fence.east[0] <= east <= fence.east[1]
    return level and -down <= fence.height


def _first_broken(leg: PlannedLeg, acts: Broken, walls: tuple[InsideFence, ...]) -> Point3 | None:
    """Return the first point of a leg at which a failsafe acts.

    Nothing changes between two crossings of walls, so that the crossings and one point between
    each two of them are enough.
    """
    cuts = sorted({0.0, 1.0, *(cut for wall in walls for cut in _crossings(leg, wall))})
    middles = [(one + other) / 2.0 for one, other in pairwise(cuts)]
    for share in sorted({*cuts, *middles}):
        point = _along(leg, share)
        if acts(point):
            return point
    return None


def _crossings(leg: PlannedLeg, fence: InsideFence) -> Iterator[float]:
    planes = ((0, fence.north), (1, fence.east), (2, (-fence.height,)))
    for axis, limits in planes:
        step = leg.end[axis] - leg.start[axis]
        for limit in limits:
            share = (limit - leg.start[axis]) / step if step else -1.0
            if 0.0 < share < 1.0:
                yield share


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
