"""What a behaviour is given and the flight makes nothing of: speeds above the limits, lone events.

Also the height of a vehicle that follows a target, which no leg of the plan shows.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterator

from missionkit.behaviors.climb import Climb
from missionkit.behaviors.follow import Follow
from missionkit.behaviors.waypoints import Waypoints
from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.checks.implausible_goals import LOWEST
from missionkit.chart.semantics.actions_and_events import matches
from missionkit.control.velocity_limits import Limits
from missionkit.errors import Level, Place, Problem
from missionkit.plugin import Plugin


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield a warning for each parameter of a behaviour that cannot be what is meant."""
    control = chart.mission.velocity_control
    ways = (way for each in chart.ways.values() for way in each)
    heard = tuple(sorted({word for way in ways for word in way.model.event or ()}))
    for name, state, _ in chart.tree.states.values():
        behavior = state.behavior
        if behavior is None or not behavior.place.file:
            continue
        if control is not None and isinstance(behavior.plugin, Plugin):
            yield from _too_fast(name, behavior.plugin, behavior.place, control.limits)
        if isinstance(behavior.plugin, Waypoints):
            yield from _unheard(name, behavior.plugin, behavior.place, heard)
        if isinstance(behavior.plugin, Follow) and chart.tree.catalogue.vehicle.over_ground:
            yield from _too_low(name, behavior.plugin, behavior.place)


def _too_fast(name: str, plugin: Plugin, place: Place, limits: Limits) -> Iterator[Problem]:
    upright = isinstance(plugin, Climb)
    limit = max(limits.climb, limits.descent) if upright else limits.speed
    speed = getattr(plugin, "speed", None) if "speed" in plugin.model_fields_set else None
    speeds = [] if speed is None else [float(speed)]
    if isinstance(plugin, Waypoints):
        speeds += [each.speed for each in plugin.places if each.speed is not None]
    fastest = max(speeds, default=0.0)
    if fastest > limit:
        yield Problem(
            place,
            f"state {name!r}: the vehicle flies no faster than {limit:g} m/s, its limit, not the "
            f"{fastest:g} m/s asked for",
            Level.WARNING,
            "speed-above-limit",
            f"speed: {limit:g}, or 'control: {{limits: ...}}'",
        )


def _unheard(
    name: str, plugin: Waypoints, place: Place, heard: tuple[str, ...]
) -> Iterator[Problem]:
    for number, each in enumerate(plugin.places, 1):
        if each.event is None or matches(tuple(map(_prefix, heard)), each.event):
            continue
        near = difflib.get_close_matches(each.event, heard, n=1)
        meant = f"; {near[0]!r} is waited for" if near else ""
        yield Problem(
            place,
            f"state {name!r}: no transition waits for the event {each.event!r} of place {number}"
            f"{meant}",
            Level.WARNING,
            "event-unheard",
            f"event: {near[0]}"
            if near
            else f"a transition with 'event: {each.event}', or no event",
        )


def _prefix(event: str) -> str:
    return event if event == "*" else event.removesuffix("*").removesuffix(".")


def _too_low(name: str, plugin: Follow, place: Place) -> Iterator[Problem]:
    if plugin.height is not None and plugin.height < LOWEST:
        yield Problem(
            place,
            f"state {name!r}: it follows {plugin.target!r} {plugin.height:g} m above the take-off "
            "point: the vehicle comes down on the ground",
            Level.WARNING,
            "below-ground",
            f"height: more than {LOWEST:g}",
        )
