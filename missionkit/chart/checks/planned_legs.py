"""Where the mission means to fly: the goals of its states and the straight legs between them."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from typing import NamedTuple

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.model.state_definitions import State
from missionkit.errors import Place

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
            goal = goal_of(chart, state, start)
            if goal is not None and state.behavior is not None:
                yield PlannedLeg(start, goal, before, name, state.behavior.place)
            end = start if goal is None else goal
            for way in chart.ways[name]:
                waiting += [(each, end, name) for each in way.model.targets if way.may]


def goal_of(chart: AnalysedChart, state: State, start: Point3) -> Point3 | None:
    """Return where a state's behaviour takes the vehicle, None if it is not known exactly.

    Args:
        chart: of the whole mission, for the positions of its targets.
        state: of which the behaviour is looked at.
        start: m, NED, where the vehicle is when the state is entered.

    Returns:
        m, NED, or `None`.
    """
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
