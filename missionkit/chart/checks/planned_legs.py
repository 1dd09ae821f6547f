"""Where the mission means to fly: the goals of its states and the straight legs between them."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from typing import NamedTuple

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.model.state_definitions import State
from missionkit.errors import Place
from missionkit.plugin import Behavior
from missionkit.plugin_containment import is_foreign

MOST_STARTS = 8  # goals that one state may be entered from
MOST_ENTRIES = 20_000  # entries of states, in one mission
Point3 = tuple[float, float, float]  # m, NED


class PlannedLeg(NamedTuple):
    """A straight line from where one state ends to the goal of another."""

    start: Point3
    end: Point3
    before: str  # the state it comes from
    state: str
    place: Place
    number: int = 1  # of the place it leads to, among those of its state
    of: int = 1  # places of its state


def legs(chart: AnalysedChart) -> Iterator[PlannedLeg]:
    """Yield each leg, from the take-off on; states without a goal pass on where they began."""
    starts: dict[str, list[tuple[Point3, str]]] = {}
    waiting = deque((to, (0.0, 0.0, 0.0), "") for to in chart.mission.initial.to)
    left = MOST_ENTRIES
    while waiting and left > 0:
        to, start, before = waiting.popleft()
        left -= len(chart.tree.entered(to))
        for name in sorted(chart.tree.entered(to)):
            known = starts.setdefault(name, [])
            if len(known) >= MOST_STARTS or any(start == point for point, _ in known):
                continue
            known.append((start, before))
            state = chart.tree.states[name].state
            end, origin = start, before
            way = way_of(chart, state, start)
            for number, place in enumerate(way, 1):
                if state.behavior is not None:
                    at = state.behavior.place
                    yield PlannedLeg(end, place, origin, name, at, number, len(way))
                end, origin = place, name
            for out in chart.ways[name]:
                waiting += [(each, end, name) for each in out.model.targets if out.may]


def way_of(chart: AnalysedChart, state: State, start: Point3) -> tuple[Point3, ...]:
    """Return the places to which a state's behaviour takes the vehicle; empty: not known.

    Args:
        chart: of the whole mission, for the positions of its targets.
        state: of which the behaviour is looked at.
        start: m, NED, where the vehicle is when the state is entered.
    """
    plugin = None if state.behavior is None else state.behavior.plugin
    if isinstance(plugin, Behavior) and not is_foreign(plugin):
        ready = plugin.with_camera(chart.mission.camera.model())
        targets = {name: it.position for name, it in chart.mission.targets.items()}
        if way := ready.way(start, targets):
            return way
    goal = _goal_of(chart, state, start)
    return () if goal is None else (goal,)


def _goal_of(chart: AnalysedChart, state: State, start: Point3) -> Point3 | None:
    """Return the one place a behaviour goes to, None if it is not known exactly."""
    if state.behavior is None:
        return None
    plugin = state.behavior.plugin
    height = getattr(plugin, "height", None)
    match state.behavior.kind:
        case "take_off":
            return (start[0], start[1], -float(height or 0.0))
        case "go_to" | "ddp_go_to" | "servo" | "inject":
            target = str(getattr(plugin, "target", ""))
            if target == "home":
                return (0.0, 0.0, start[2] if height is None else -float(height))
            goal = _off(chart, target, getattr(plugin, "standoff", (0.0, 0.0, 0.0)))
            if goal is None and state.behavior.kind in {
                "go_to",
                "ddp_go_to",
            }:  # until its marker was seen
                surveyed = chart.mission.targets.get(target)  # None: it is tracked
                goal = None if surveyed is None else surveyed.position
            return goal if goal is None or height is None else (*goal[:2], -float(height))
        case _:
            return None


def _off(chart: AnalysedChart, name: str, standoff: tuple[float, float, float]) -> Point3 | None:
    """Return the point `standoff` = out, right, up off a marker, None if it may face anywhere."""
    target = chart.mission.targets.get(name)
    if target is None:
        return None
    north, east, down = target.position
    out, right, up = standoff
    if not (out or right):
        return (north, east, down - up)
    if target.facing_deg is None:
        return None
    facing = math.radians(target.facing_deg)
    towards, aside = (math.cos(facing), math.sin(facing)), (math.sin(facing), -math.cos(facing))
    return (
        north + out * towards[0] + right * aside[0],
        east + out * towards[1] + right * aside[1],
        down - up,
    )
