"""Speeds from which the vehicle cannot stop within what its scanner sees."""

from __future__ import annotations

from collections.abc import Iterator

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.errors import Level, Problem
from missionkit.number_text import beside, rounded_down, rounded_up
from missionkit.planning.obstacle_braking import stopping_distance
from missionkit.planning.potential_field import PotentialField


def problems_of(chart: AnalysedChart, sight: float) -> Iterator[Problem]:
    """Yield a warning for each behaviour that is too fast to stop.

    Args:
        chart: the mission's.
        sight: how far (m) the scanner sees.
    """
    avoid, control = chart.mission.avoid, chart.mission.velocity_control
    if avoid is None or control is None or not isinstance(avoid.plugin, PotentialField):
        return
    field, limits = avoid.plugin, control.limits
    seen = sight if field.sight is None else min(sight, field.sight)
    top = field.admissible(seen)
    for name, state, _ in chart.tree.states.values():
        behavior = state.behavior
        if behavior is None or not behavior.place.file:
            continue
        speed = min(float(getattr(behavior.plugin, "speed", 0.0)), limits.speed)
        if speed > top:
            needed = stopping_distance(speed, field.stopping) + field.stopping.width
            within, limit = beside(needed, seen, 1)
            yield Problem(
                behavior.place,
                f"state {name!r}: from {speed:g} m/s it stops within {within} m, but obstacles "
                f"are seen {limit} m away: it will fly at {beside(top, speed, 1)[0]} m/s",
                Level.WARNING,
                "too-fast-to-stop",
                f"a speed of at most {rounded_down(top, 1)}, or a scanner that sees "
                f"{rounded_up(needed, 1)} m",
            )
