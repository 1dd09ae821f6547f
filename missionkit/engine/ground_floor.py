"""Descending before the ground: only a landing goes lower than the mission's own places."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from missionkit.control.velocity_limits import ZERO, Limits, stopping_speed
from missionkit.geometry import vec
from missionkit.messages import Estimate, Setpoint
from missionkit.plugin import Behavior
from missionkit.plugin_containment import is_foreign
from missionkit.plugin_protocols import BehaviorProtocol

FLOOR_HEIGHT = 1.0  # m above where it took off, that guidance keeps: a barometer drifts by as much
FLOOR_CLIMB = 0.5
"""m/s at most, and 1/s, back to the floor: a vehicle sinks a little while it hovers."""
HIGH = (0.0, 0.0, -1_000.0)  # m, NED: a start that does not count
BELOW = 0.5  # m below the lowest place that the mission names, if that is lower


def floor_of(behaviors: Iterable[BehaviorProtocol | None], surveyed: Mapping[str, float]) -> float:
    """Return how far down (m, NED) guidance may lead.

    A mission that works near the ground, or downhill, says so by its places; a target whose
    estimate has sunk leads no lower than those. Behaviours of other packages say nothing of where
    they lead, and go where they like.

    Args:
        behaviors: of all states.
        surveyed: m, NED, how far down each target is.
    """
    flown = [behavior for behavior in behaviors if behavior is not None]
    if any(is_foreign(behavior) for behavior in flown):
        return math.inf
    return max([-FLOOR_HEIGHT, *(down + BELOW for it in flown for down in _places(it, surveyed))])


def _places(behavior: BehaviorProtocol, surveyed: Mapping[str, float]) -> Iterable[float]:
    height = getattr(behavior, "height", None)
    if height is not None:
        yield -height
    if isinstance(behavior, Behavior):
        known = {name: (0.0, 0.0, down) for name, down in surveyed.items()}
        yield from (down for _, _, down in behavior.way(HIGH, known))
    down = surveyed.get(getattr(behavior, "target", ""))
    if down is not None:
        standoff = getattr(behavior, "standoff", ZERO)
        yield down - (standoff[2] if isinstance(standoff, tuple) else 0.0)


def above_floor(setpoint: Setpoint, seen: Estimate, floor: float, limits: Limits) -> Setpoint:
    """Return the setpoint with no faster a descent than stops above the floor; below, it climbs.

    Args:
        setpoint: about to be sent.
        seen: the estimate at this tick.
        floor: m, NED.
        limits: `vertical_braking`, after the vehicle's `lag`.
    """
    gap = floor - float(seen.position[2])
    top = max(-FLOOR_CLIMB, gap)
    if gap > 0.0:
        top = stopping_speed(gap, limits.vertical_braking, limits.lag)
    north, east, down = setpoint.velocity.tolist()
    if not down > top:
        return setpoint
    return setpoint._replace(velocity=vec(north, east, top))
