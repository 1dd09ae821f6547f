"""Uploaded fences, and the limits of distance and height in the parameters.

https://mavlink.io/en/services/mission.html#geofence-mission-items; PX4:
https://docs.px4.io/main/en/flying/geofence.html (GF_ACTION; inside any inclusion will do);
ArduPilot: https://ardupilot.org/copter/docs/ac2_simple_geofence.html, /polygon_fence.html
(FENCE_ENABLE, FENCE_TYPE, FENCE_ACTION; inside every inclusion).
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

from missionkit import polygons
from missionkit.sitl.flight_modes import FlightTask
from missionkit.sitl.geodetic import Earth, GeographicPoint
from missionkit.sitl.pymavlink_dialect import mavlink
from missionkit.sitl.sitl_state import SitlState, take_over
from missionkit.sitl.stored_plans import FENCE_ITEMS, Item

INSIDE = (
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION,
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION,
)
CORNERS = (
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION,
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION,
)
CIRCLES = (
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION,
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION,
)
FENCE_HEIGHT, FENCE_CIRCLE, FENCE_POLYGON = 1, 2, 4  # bits of FENCE_TYPE
PX4_ACTIONS = {2: FlightTask.HOLD, 3: FlightTask.RETURN, 5: FlightTask.LAND}  # GF_ACTION
ARDUPILOT_ACTIONS = {1: FlightTask.RETURN, 2: FlightTask.LAND, 4: FlightTask.HOLD}  # FENCE_ACTION
Place = tuple[float, float]  # m, north and east


class FenceShape(NamedTuple):
    """A polygon, or a circle around its only corner."""

    inclusion: bool
    corners: tuple[Place, ...]
    radius: float  # m, of a circle

    def holds(self, place: Place) -> bool:
        """Tell whether a place is inside."""
        if len(self.corners) == 1:
            return math.dist(place, self.corners[0]) <= self.radius
        return polygons.contains(self.corners, place)


@lru_cache(maxsize=8)
def shapes(items: tuple[Item, ...], earth: Earth) -> tuple[FenceShape, ...]:
    """Return the shapes that the items of a fence describe."""
    found, at = [], 0
    while at < len(items):
        item = items[at]
        count = max(1, round(item.params[0])) if item.command in CORNERS else 1
        if item.command in {*CORNERS, *CIRCLES}:
            corners = tuple(_place(corner, earth) for corner in items[at : at + count])
            found.append(FenceShape(item.command in INSIDE, corners, item.params[0]))
        at += count
    return tuple(found)


def _place(item: Item, earth: Earth) -> Place:
    position = earth.position(GeographicPoint(item.x / 1e7, item.y / 1e7, 0.0))
    return float(position[0]), float(position[1])


def outside(state: SitlState) -> bool:
    """Tell whether the vehicle is where the uploaded fence does not let it be."""
    here = (float(state.body.position[0]), float(state.body.position[1]))
    fences = shapes(state.plans.items[FENCE_ITEMS], state.earth)
    kept = [shape.holds(here) for shape in fences if shape.inclusion]
    inside = any(kept) if state.dialect.name == "px4" else all(kept)
    out = bool(kept) and not inside
    return out or any(shape.holds(here) for shape in fences if not shape.inclusion)


def _beyond(state: SitlState, away: float, height: float) -> bool:
    """Tell whether it is farther from home or higher than allowed (m), 0: no limit."""
    gap = state.body.position - state.home
    far = away > 0.0 and math.hypot(gap[0], gap[1]) > away
    return far or (height > 0.0 and -float(gap[2]) > height)


def breached(state: SitlState) -> bool:
    """Tell whether any fence is breached."""
    value = state.parameters
    if state.dialect.name == "px4":
        limits = (value["GF_MAX_HOR_DIST"], value["GF_MAX_VER_DIST"])
        return _beyond(state, *limits) or outside(state)
    if not value["FENCE_ENABLE"]:
        return False
    kinds = int(value["FENCE_TYPE"])
    away = value["FENCE_RADIUS"] if kinds & FENCE_CIRCLE else 0.0
    height = value["FENCE_ALT_MAX"] if kinds & FENCE_HEIGHT else 0.0
    return _beyond(state, away, height) or (bool(kinds & FENCE_POLYGON) and outside(state))


def watch(state: SitlState) -> None:
    """Act when a fence is breached; once until it is inside again."""
    if not state.in_air or not breached(state):
        state.warned.discard("geofence")
        return
    px4 = state.dialect.name == "px4"
    action = int(state.parameters["GF_ACTION" if px4 else "FENCE_ACTION"])
    flight = (PX4_ACTIONS if px4 else ARDUPILOT_ACTIONS).get(action)
    if flight is not None:
        take_over(state, "geofence", flight)
    elif px4 and action == 4:
        state.body.kill()
    elif action:
        state.warn_once("geofence", "Geofence breached")
