"""Standoffs at which the vehicle touches what it works on."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.checks.planned_legs import Point3
from missionkit.chart.model.state_definitions import State
from missionkit.errors import Level, Problem
from missionkit.goal_pose import HOVER_SLACK
from missionkit.number_text import rounded_up
from missionkit.planning.potential_field import PotentialField


class Reach(NamedTuple):
    """From where to where a behaviour stands off its target: out, right, up (m)."""

    target: str
    far: Point3
    near: Point3
    kind: str
    turn_deg: float = 0.0  # of the nose from facing the marker

    @property
    def least(self) -> float:
        """Return the least distance (m) from the target, negative behind the marker's plane."""
        return math.copysign(math.hypot(*self.near), self.near[0])


def reach_of(state: State) -> Reach | None:
    """Return how near a state's behaviour works on its target, None if it works on none."""
    if state.behavior is None:
        return None
    kind, plugin = state.behavior.kind, state.behavior.plugin
    standoff, target = getattr(plugin, "standoff", None), str(getattr(plugin, "target", ""))
    if kind == "spiral":
        if getattr(plugin, "centre", "here") == "target":
            return None  # it flies over its target
        out = float(standoff or 0.0)
        return Reach(target, (out, 0.0, 0.0), (out, 0.0, 0.0), kind)
    if kind not in {"servo", "inject"} or standoff is None:
        return None
    out, right, up = standoff
    depth = float(getattr(plugin, "depth", 0.0))
    turn = float(getattr(plugin, "turn_deg", 0.0))
    return Reach(target, (out, right, up), (out - depth, right, up), kind, turn)


def body_radius(chart: AnalysedChart) -> float:
    """Return the radius (m) that the mission gives its vehicle."""
    avoid = chart.mission.avoid
    given = None if avoid is None else avoid.plugin
    return (given if isinstance(given, PotentialField) else PotentialField()).body_radius


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield each behaviour that takes the vehicle into its target, or too near to it."""
    radius = body_radius(chart)
    for name, state, _ in chart.tree.states.values():
        reach = reach_of(state)
        if reach is None or state.behavior is None or not state.behavior.place.file:
            continue
        least, room = reach.least, radius + HOVER_SLACK
        if least >= room:
            continue
        where = (
            f"state {name!r}: {reach.kind!r} goes to {least:g} m in front of {reach.target!r}"
            if reach.near[0] > 0.0
            else f"state {name!r}: {reach.kind!r} goes to the marker of {reach.target!r} itself, "
            "or behind it"
        )
        touches = least <= radius
        why = (
            f"the vehicle's own radius is {radius:g} m"
            if touches
            else f"its own radius is {radius:g} m, and it stops within {HOVER_SLACK:g} m"
        )
        depth = reach.far[0] - reach.near[0]
        more = f" ('standoff' less 'depth': {depth:g})" if depth else ""
        yield Problem(
            state.behavior.place,
            f"{where}{more}: {why}",
            Level.ERROR if touches else Level.WARNING,
            "touches-target" if touches else "close-to-target",
            f"a standoff of at least {rounded_up(room + depth, 2)} m",
        )
