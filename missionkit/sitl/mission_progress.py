"""Which leg of an uploaded mission is being flown.

Flown: NAV_TAKEOFF, NAV_WAYPOINT, NAV_LOITER_TIME, NAV_LAND, NAV_RETURN_TO_LAUNCH,
DO_CHANGE_SPEED; other items are passed over. https://mavlink.io/en/services/mission.html.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from missionkit.geometry import Vec3, vec
from missionkit.sitl.flight_modes import FlightTask
from missionkit.sitl.geodetic import GeographicPoint
from missionkit.sitl.pymavlink_dialect import mavlink
from missionkit.sitl.setpoint_tracking import SetpointTarget, towards
from missionkit.sitl.sitl_state import SitlState
from missionkit.sitl.stored_plans import Item

GLOBAL_FRAMES = (mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT)
RELATIVE_FRAMES = (
    mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
    mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
    mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT,
    mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT,
)
PLACES = (mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_CMD_NAV_LOITER_TIME)
ACTIONS = {
    mavlink.MAV_CMD_NAV_TAKEOFF: FlightTask.TAKE_OFF,
    mavlink.MAV_CMD_NAV_LAND: FlightTask.LAND,
    mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: FlightTask.RETURN,
}


class MissionLeg(NamedTuple):
    """One item that takes time."""

    aim: SetpointTarget | None = None
    action: FlightTask | None = None
    height: float = 0.0  # m above home, of a take-off
    radius: float = 1.0  # m
    stay: float = 0.0  # s


def place(state: SitlState, item: Item) -> Vec3:
    """Return where an item is, (3,), m, NED; above terrain is taken for above home.

    Without a height (NaN) it is as high as the vehicle is now.
    """
    here = state.earth.position
    if not math.isfinite(item.z):
        level = here(GeographicPoint(item.x / 1e7, item.y / 1e7, 0.0))
        return vec(level[0], level[1], float(state.body.position[2]))
    height = float(item.z)
    if item.frame in RELATIVE_FRAMES:
        height += state.earth.origin.height - float(state.home[2])
    return here(GeographicPoint(item.x / 1e7, item.y / 1e7, height))


def leg(state: SitlState, cruise: float) -> MissionLeg | None:
    """Return the present leg, passing over items that take no time; `None` after the last."""
    plans = state.plans
    if plans.current == 0 and state.dialect.name == "ardupilot":
        plans.current = 1  # ArduPilot keeps home in the first one
    while plans.current < len(plans.mission):
        item = plans.mission[plans.current]
        if item.command in ACTIONS:
            height = float(state.home[2] - place(state, item)[2])
            return MissionLeg(action=ACTIONS[item.command], height=height)
        if item.command in PLACES:
            return _way(state, item, cruise)
        if item.command == mavlink.MAV_CMD_DO_CHANGE_SPEED and item.params[1] > 0.0:
            state.speed = item.params[1]
        _reached(state)
    return None


def _way(state: SitlState, item: Item, cruise: float) -> MissionLeg:
    yaw = math.radians(item.params[3]) if math.isfinite(item.params[3]) else None
    if state.dialect.name == "ardupilot":
        yaw, radius = None, state.parameters["WPNAV_RADIUS"] / 100.0
    else:
        radius = item.params[1] or state.parameters["NAV_ACC_RAD"]
    aim = towards(state.now, place(state, item), yaw=yaw, speed=cruise)
    return MissionLeg(aim=aim, radius=radius, stay=max(0.0, item.params[0]))


def arrived(state: SitlState, leg: MissionLeg) -> None:
    """Go on to the next item once it has stayed long enough."""
    if state.phase != "stay":
        state.begin("stay")
    if state.now - state.phase_since >= leg.stay:
        state.begin("")
        _reached(state)


def _reached(state: SitlState) -> None:
    plans = state.plans
    plans.reached = plans.current
    plans.current += 1
    for channel in state.channels:
        channel.send(mavlink.MAVLink_mission_item_reached_message(plans.reached), state.now)
