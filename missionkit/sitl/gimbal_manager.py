"""The gimbal of the simulated autopilot: the gimbal protocol, version 2, and DO_MOUNT_CONTROL.

Sources: https://mavlink.io/en/services/gimbal_v2.html; PX4 `src/modules/gimbal/input_mavlink.cpp`,
which refuses angles from who has not taken primary control; ArduPilot `libraries/AP_Mount`, which
takes them from everyone.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from missionkit.geometry import from_euler, wrap, yaw_of
from missionkit.messages import GimbalAngles
from missionkit.perception.camera_section import Gimbal, Mount
from missionkit.sim.gimbal import SimulatedGimbal
from missionkit.sitl.command_fields import CommandFields
from missionkit.sitl.pymavlink_dialect import Message, mavlink
from missionkit.sitl.sitl_state import SitlState

ACCEPTED, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
YAW_LOCK = mavlink.GIMBAL_MANAGER_FLAGS_YAW_LOCK
IN_EARTH_FRAME = mavlink.GIMBAL_MANAGER_FLAGS_YAW_IN_EARTH_FRAME
TARGETING = mavlink.MAV_MOUNT_MODE_MAVLINK_TARGETING
STATUS_FLAGS: Final = (
    mavlink.GIMBAL_DEVICE_FLAGS_ROLL_LOCK
    | mavlink.GIMBAL_DEVICE_FLAGS_PITCH_LOCK
    | mavlink.GIMBAL_DEVICE_FLAGS_YAW_IN_VEHICLE_FRAME
)
SENDER: Final = -2  # whoever sends the command
SECTION: Final = Gimbal(yaw_deg=(-160.0, 160.0))


def at_rest() -> SimulatedGimbal:
    """Return the gimbal as it is after a start: it looks ahead."""
    return SimulatedGimbal(SECTION, Mount(), np.random.default_rng(0))


def configure(state: SitlState, order: CommandFields) -> int:
    """Give primary control to whom the command names, or to its sender."""
    system, component = round(order.number(1)), round(order.number(2))
    if SENDER in {system, component}:
        state.gimbal_owner = order.who
    elif system == 0:
        state.gimbal_owner = None
    elif system > 0:
        state.gimbal_owner = type(order.who)(system, component)
    return int(ACCEPTED)


def turn(state: SitlState, order: CommandFields) -> int:
    """DO_GIMBAL_MANAGER_PITCHYAW."""
    if state.dialect.name == "px4" and state.gimbal_owner != order.who:
        return int(DENIED)
    pitch, yaw = order.params[0], order.params[1]
    flags = round(order.latitude or 0.0)  # param5
    now = state.gimbal.angles(state.now)
    around = now.yaw if yaw is None else math.radians(yaw)
    if yaw is not None and flags & (YAW_LOCK | IN_EARTH_FRAME):
        around = wrap(around - yaw_of(state.body.attitude))
    up = now.pitch if pitch is None else math.radians(pitch)
    state.gimbal.order(GimbalAngles(up, around), state.now)
    return int(ACCEPTED)


def mount_control(state: SitlState, order: CommandFields) -> int:
    """DO_MOUNT_CONTROL by angles: pitch, roll, which stays level, and yaw."""
    if order.height is None or round(order.height) != TARGETING:  # param7
        return int(DENIED)
    angles = GimbalAngles(math.radians(order.number(1)), math.radians(order.number(3)))
    state.gimbal.order(angles, state.now)
    return int(ACCEPTED)


def attitude_status(state: SitlState) -> Message:
    """Return GIMBAL_DEVICE_ATTITUDE_STATUS."""
    pitch, yaw = state.gimbal.angles(state.now)
    turned = from_euler(0.0, pitch, yaw)
    return mavlink.MAVLink_gimbal_device_attitude_status_message(
        0, 0, state.micros // 1000, STATUS_FLAGS, turned.tolist(), 0.0, 0.0, 0.0, 0
    )
