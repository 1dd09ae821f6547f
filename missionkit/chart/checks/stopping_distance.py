"""Speeds from which the vehicle cannot stop within what its scanner sees."""

from __future__ import annotations

from collections.abc import Iterator

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.errors import Level, Problem
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
            yield Problem(
                behavior.place,
                f"state {name!r}: from {speed:g} m/s it stops within {needed:.1f} m, but obstacles "
                f"are seen {seen:g} m away: it will fly at {top:.1f} m/s",
                Level.WARNING,
                "too-fast-to-stop",
                f"a speed of at most {int(10.0 * top) / 10.0:g}, or a scanner that sees "
                f"{needed:.0f} m",
            )
