"""Whether the battery failsafe leaves enough to come home from the farthest goal."""

from __future__ import annotations

import math
from collections.abc import Iterator

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.checks.planned_legs import PlannedLeg, legs
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.state_definitions import Failsafe
from missionkit.errors import Level, Problem
from missionkit.number_text import beside, rounded_up

ENERGY_MARGIN = 2.0  # head wind, detours and flying harder than hovering
RETURN_SPEED = 0.5  # m/s, for a return that says no speed


def problems_of(chart: AnalysedChart, endurance: float) -> Iterator[Problem]:
    """Yield a warning for each battery failsafe that acts too late for the way home.

    The way home is straight from the goal that is farthest, at the speed of the state of kind
    return, then down; at `ENERGY_MARGIN` times the power of hovering.

    Args:
        chart: the mission's.
        endurance: time (s) that the vehicle hovers on a full battery.
    """
    leg = max(legs(chart), key=_distance, default=None)
    control = chart.mission.velocity_control
    if leg is None or control is None:
        return
    for failsafe in chart.mission.failsafes:
        floor = _floor(chart, failsafe)
        kind = chart.tree.states[failsafe.to].state.kind
        if floor is None or kind != "return":
            continue
        seconds = _way_home(chart, failsafe, leg, control.limits.descent)
        needed = ENERGY_MARGIN * seconds / endurance
        if needed > floor:
            shown, limit = beside(100.0 * needed, 100.0 * floor, 0)
            yield Problem(
                failsafe.place("when"),
                f"failsafe {failsafe.name!r}: from the goal of {leg.state!r}, "
                f"{_distance(leg):.0f} m away, the way home takes {seconds:.0f} s; with a margin "
                f"of {ENERGY_MARGIN:g} that needs {shown} % of the battery, but it waits "
                f"until {limit} %",
                Level.WARNING,
                "energy",
                f"use a floor of at least {rounded_up(needed, 2)}, or fly home faster",
            )


def _distance(leg: PlannedLeg) -> float:
    return math.hypot(leg.end[0], leg.end[1])


def _way_home(chart: AnalysedChart, failsafe: Failsafe, leg: PlannedLeg, descent: float) -> float:
    behavior = chart.tree.states[failsafe.to].state.behavior
    plugin = None if behavior is None else behavior.plugin
    speed = max(float(getattr(plugin, "speed", RETURN_SPEED)), RETURN_SPEED)
    height = max(-leg.end[2], float(getattr(plugin, "height", None) or 0.0))
    return _distance(leg) / speed + height / descent


def _floor(chart: AnalysedChart, failsafe: Failsafe) -> float | None:
    """Return the charge below which a failsafe acts, None if it is about something else."""
    when = failsafe.when
    if isinstance(when, ex.Named):
        when = chart.mission.guards[when.name]
    if isinstance(when, ex.Use) and when.kind == "battery_below":
        return float(getattr(when.plugin, "floor", 0.0))
    return None
