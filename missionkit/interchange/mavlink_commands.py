"""Numbers of MAVLink that plans are made of: https://mavlink.io/en/messages/common.html."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from missionkit.interchange.plan import Reference

WAYPOINT, LOITER_TURNS, LOITER_TIME, RETURN, LAND, TAKE_OFF = 16, 18, 19, 20, 21, 22
DELAY, CHANGE_SPEED, ROI_LOCATION, ROI_NONE, ROI = 93, 178, 195, 197, 201
DIGICAM, IMAGE_START = 203, 2000

NAMES: Mapping[int, str] = MappingProxyType(
    {
        WAYPOINT: "NAV_WAYPOINT",
        17: "NAV_LOITER_UNLIM",
        LOITER_TURNS: "NAV_LOITER_TURNS",
        LOITER_TIME: "NAV_LOITER_TIME",
        RETURN: "NAV_RETURN_TO_LAUNCH",
        LAND: "NAV_LAND",
        TAKE_OFF: "NAV_TAKEOFF",
        31: "NAV_LOITER_TO_ALT",
        82: "NAV_SPLINE_WAYPOINT",
        84: "NAV_VTOL_TAKEOFF",
        85: "NAV_VTOL_LAND",
        DELAY: "NAV_DELAY",
        112: "CONDITION_DELAY",
        114: "CONDITION_DISTANCE",
        115: "CONDITION_YAW",
        177: "DO_JUMP",
        CHANGE_SPEED: "DO_CHANGE_SPEED",
        179: "DO_SET_HOME",
        181: "DO_SET_RELAY",
        183: "DO_SET_SERVO",
        189: "DO_LAND_START",
        ROI_LOCATION: "DO_SET_ROI_LOCATION",
        ROI_NONE: "DO_SET_ROI_NONE",
        ROI: "DO_SET_ROI",
        DIGICAM: "DO_DIGICAM_CONTROL",
        205: "DO_MOUNT_CONTROL",
        206: "DO_SET_CAM_TRIGG_DIST",
        211: "DO_GRIPPER",
        530: "SET_CAMERA_MODE",
        1000: "DO_GIMBAL_MANAGER_PITCHYAW",
        IMAGE_START: "IMAGE_START_CAPTURE",
        2001: "IMAGE_STOP_CAPTURE",
        2500: "VIDEO_START_CAPTURE",
        2501: "VIDEO_STOP_CAPTURE",
    }
)
_CAMERA = "the camera is worked by 'payload' of a survey or a waypoint: add it there"
_GIMBAL = "a mission does not turn a gimbal on the way"
_OUTPUT = "an output of the autopilot has another name in a mission: add it by 'payload'"
REASONS: Mapping[int, str] = MappingProxyType(
    {
        17: "it stays there without end: a mission waits for an event in a state of its own",
        31: "a climb in circles: add a state with 'orbit' and 'to_height'",
        82: "a curve: a mission flies straight legs, place waypoints on it",
        84: "a take-off of a fixed wing",
        85: "a landing of a fixed wing",
        112: "it delays other items",
        114: "it delays other items",
        115: "the nose turns by 'heading_deg' of a waypoint",
        177: "a jump: write it as a transition between states",
        179: "home is where the vehicle takes off",
        181: _OUTPUT,
        183: _OUTPUT,
        189: "it marks a landing pattern",
        205: _GIMBAL,
        206: _CAMERA,
        211: _OUTPUT,
        530: _CAMERA,
        1000: _GIMBAL,
        2001: _CAMERA,
        2500: _CAMERA,
        2501: _CAMERA,
    }
)
FRAMES: Mapping[int, Reference] = MappingProxyType(
    {0: "amsl", 5: "amsl", 3: "above_home", 6: "above_home", 10: "agl", 11: "agl"}
)
MISSION_FRAME = 2  # of items without a place
FRAME_OF: Mapping[Reference, int] = MappingProxyType({"amsl": 0, "above_home": 3, "agl": 10})
Params = tuple[
    float | None,
    float | None,
    float | None,
    float | None,
    float | None,
    float | None,
    float | None,
]


class MissionItem(NamedTuple):
    """One item of a MAVLink mission; a parameter that is NaN or not given is None."""

    command: int
    frame: int
    params: Params
    item: int = 0  # of the ledger
    proceeds: bool = True  # autocontinue
    amsl: float | None = None  # height that a ground station has worked out from a terrain model


def name_of(command: int) -> str:
    """Return the name of a command, as its number where it has none here."""
    return NAMES.get(command, f"MAV_CMD {command}")
