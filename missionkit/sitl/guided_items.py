"""Single mission items that are flown at once: ArduPilot's guided mode without setpoints.

MISSION_ITEM with `current` 2 is a place to fly to, with 3 a height to change to. Source: ArduPilot
`libraries/GCS_MAVLink/GCS_Common.cpp` (handle_mission_item), `ArduCopter/GCS_Mavlink.cpp`
(handle_guided_request).
"""

from __future__ import annotations

from missionkit.sitl.command_fields import CommandFields
from missionkit.sitl.flight_modes import FlightTask
from missionkit.sitl.peer_channel import Channel, Sender
from missionkit.sitl.pymavlink_dialect import mavlink
from missionkit.sitl.setpoint_tracking import towards
from missionkit.sitl.sitl_state import SitlState
from missionkit.sitl.stored_plans import Item

FLY_TO, CHANGE_HEIGHT = 2, 3  # of `current`


def is_guided(state: SitlState, current: int) -> bool:
    """Say whether an item is to be flown at once instead of stored.

    Args:
        state: of the autopilot: PX4 knows no such items.
        current: of the item.
    """
    return state.dialect.name == "ardupilot" and current in {FLY_TO, CHANGE_HEIGHT}


def fly(state: SitlState, channel: Channel, who: Sender, item: Item) -> int:
    """Fly to an item now; return the MAV_MISSION_RESULT.

    Args:
        state: of the autopilot; its target is changed.
        channel: on which the item came.
        who: sent it.
        item: a waypoint.
    """
    if item.command != mavlink.MAV_CMD_NAV_WAYPOINT:
        return int(mavlink.MAV_MISSION_UNSUPPORTED)
    if state.mode.does is not FlightTask.COMMANDED or not state.in_air:
        return int(mavlink.MAV_MISSION_ERROR)
    level = item.current == FLY_TO
    order = CommandFields(
        item.command,
        (None, None, None, None),
        item.x / 1e7 if level else None,
        item.y / 1e7 if level else None,
        item.z,
        item.frame,
        channel,
        who,
    )
    state.target = towards(state.now, order.place(state, state.body.position), speed=state.speed)
    return int(mavlink.MAV_MISSION_ACCEPTED)
