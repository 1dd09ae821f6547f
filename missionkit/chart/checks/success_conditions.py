"""Conditions of success that can never be met, or that say nothing."""

from __future__ import annotations

import math
from collections.abc import Iterator

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.checks.planned_legs import Point3
from missionkit.chart.checks.plugin_requirements import looked_for
from missionkit.chart.checks.reachability import reachable
from missionkit.chart.checks.standoffs import body_radius, reach_of
from missionkit.chart.model.mission_sections import Success
from missionkit.chart.model.state_definitions import State
from missionkit.errors import Level, Place, Problem
from missionkit.number_text import beside_short, rounded_down
from missionkit.planning.potential_field import PotentialField

NEVER_MET = "success-never-met"
SAYS_NOTHING = "success-says-nothing"
CLEARANCE_NOT_KEPT = "clearance-not-kept"
MOST_CLEARANCE = 100.0  # m


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield each condition of success that no flight of this chart can meet, or that all do."""
    alive = reachable(chart)
    for one in chart.mission.success:
        yield from _unreached(chart, one, alive)
        yield from _unfinished(chart, one, alive)
        yield from _goal(chart, one)
        yield from _clearance(chart, one)


def _problem(place: Place, says: str, level: Level, code: str, remedy: str) -> Problem:
    return Problem(place, f"success: {says}", level, code, remedy)


def _unreached(chart: AnalysedChart, one: Success, alive: set[str]) -> Iterator[Problem]:
    state = one.visit
    if state is None:
        return
    if state not in alive and chart.tree.states[state].state.history is None:
        says = f"it requires a visit to {state!r}, which can never be reached"
        remedy = "add a transition that leads there, or name another state"
        yield _problem(one.place("visit"), says, Level.ERROR, NEVER_MET, remedy)
    elif one.target is None and state in chart.mission.initial.to:
        says = f"every flight visits {state!r}: it begins there"
        remedy = "name a state that the mission has to get to"
        yield _problem(one.place("visit"), says, Level.WARNING, SAYS_NOTHING, remedy)


def _unfinished(chart: AnalysedChart, one: Success, alive: set[str]) -> Iterator[Problem]:
    name = one.done
    if name is None:
        return
    if name not in alive:
        why = "it can never be reached"
    elif chart.reader.done(name).may:
        return
    else:
        why = _endless(chart.tree.states[name].state)
    says = f"it requires that {name!r} finishes, but {why}"
    remedy = (
        "name a state whose behaviour ends by itself, or require a 'visit' to the state after it"
    )
    yield _problem(one.place("done"), says, Level.ERROR, NEVER_MET, remedy)


def _endless(state: State) -> str:
    if state.states or state.behavior is None:
        return "it has no final state inside"
    return f"{state.behavior.kind!r} runs until something else ends it"


def _goal(chart: AnalysedChart, one: Success) -> Iterator[Problem]:
    if one.target is None:
        return
    target, place = chart.mission.targets[one.target], one.place("target")
    if one.target not in looked_for(chart):
        says = f"it needs the marker of {one.target!r}, which 'perception' does not list"
        remedy = f"perception: [{{use: aruco, target: {one.target}, id: ..., size: ...}}]"
        yield _problem(place, says, Level.ERROR, NEVER_MET, remedy)
        return
    farthest = math.dist(target.position, (0.0, 0.0, 0.0))
    if one.position >= farthest + math.hypot(*one.standoff):
        says = f"the take-off point is already within {one.position:g} m of {one.target!r}"
        remedy = "a smaller 'position', in metres"
        yield _problem(one.place("position"), says, Level.WARNING, SAYS_NOTHING, remedy)
    yield from _not_aimed_at(chart, one, place)


def _not_aimed_at(chart: AnalysedChart, one: Success, place: Place) -> Iterator[Problem]:
    """Yield the condition if every behaviour is known and none goes to its place."""
    misses = []
    for _, state, _ in chart.tree.states.values():
        if state.behavior is None or one.target not in state.behavior.plugin.targets():
            continue
        ends = _ends(chart, state, one.target or "")
        if ends is None:
            return
        misses.append((_distance(one.standoff, *ends), state.behavior.kind))
    if not misses:
        says = f"no state goes to {one.target!r}"
        remedy = f"a behaviour with 'target: {one.target}', or another target here"
        yield _problem(place, says, Level.WARNING, NEVER_MET, remedy)
        return
    (least, within), kind = min(misses)
    if least > one.position + within:
        shown, limit = beside_short(least, one.position, 2)
        says = (
            f"it requires {_listed(one.standoff)} from {one.target!r}, within {limit} m, "
            f"but the nearest behaviour, {kind!r}, goes {shown} m away from that"
        )
        remedy = "the 'standoff' of the behaviour that goes there"
        yield _problem(place, says, Level.WARNING, NEVER_MET, remedy)


def _ends(chart: AnalysedChart, state: State, target: str) -> tuple[Point3, Point3, float] | None:
    """Return from where to where a behaviour stands off its target, and how loosely (m)."""
    if state.behavior is None:
        return None
    kind, plugin = state.behavior.kind, state.behavior.plugin
    reach = reach_of(state)
    if reach is not None:
        return None if kind == "spiral" else (reach.far, reach.near, 0.0)
    if kind not in {"go_to", "ddp_go_to"}:
        return None
    out, right, up = getattr(plugin, "standoff", (0.0, 0.0, 0.0))
    height = getattr(plugin, "height", None)
    if height is not None:
        up = chart.mission.targets[target].position[2] + float(height)
    end = (out, right, up)
    return end, end, float(getattr(plugin, "within", 0.0))


def _distance(point: Point3, far: Point3, near: Point3, within: float) -> tuple[float, float]:
    """Return the distance (m) from a point to a segment, and how loosely that is flown (m)."""
    depth = far[0] - near[0]
    along = 0.0 if depth <= 0.0 else min(1.0, max(0.0, (far[0] - point[0]) / depth))
    return math.dist(point, (far[0] - along * depth, *far[1:])), within


def _listed(point: Point3) -> str:
    return f"[{', '.join(f'{value:g}' for value in point)}]"


def _clearance(chart: AnalysedChart, one: Success) -> Iterator[Problem]:
    required = one.clearance
    if required is None:
        return
    if required > MOST_CLEARANCE:
        says = f"it requires {required:g} m from every obstacle: more than {MOST_CLEARANCE:g} m"
        yield _problem(
            one.place("clearance"), says, Level.WARNING, CLEARANCE_NOT_KEPT, "give it in metres"
        )
        return
    nearest = min(_kept(chart), default=None)
    if nearest is not None and required > nearest[0]:
        kept, what = max(0.0, nearest[0]), nearest[1]
        shown, limit = beside_short(kept, required, 2)
        says = f"it requires {limit} m from every obstacle, but {what} {shown} m"
        remedy = f"a clearance of at most {rounded_down(kept, 2)}, or a behaviour that keeps more"
        yield _problem(one.place("clearance"), says, Level.WARNING, CLEARANCE_NOT_KEPT, remedy)


def _kept(chart: AnalysedChart) -> Iterator[tuple[float, str]]:
    """Yield what each state keeps (m) of obstacles, and in words how."""
    radius, avoid = body_radius(chart), chart.mission.avoid
    field = None if avoid is None else avoid.plugin
    for name, state, _ in chart.tree.states.values():
        if state.behavior is None:
            continue
        reach = reach_of(state)
        if reach is not None and reach.kind != "spiral":
            left = reach.least - radius
            yield left, f"state {name!r} works on {reach.target!r} from"
        elif state.behavior.kind in {"follow_path", "ddp_go_to"}:
            kept = float(getattr(state.behavior.plugin, "clearance", math.inf))
            yield kept, f"the path of state {name!r} keeps only"
        elif state.behavior.kind == "go_to" and isinstance(field, PotentialField):
            yield field.clearance, f"in state {name!r} 'avoid' lets it come as near as"
