"""SET_POSITION_TARGET_* and SET_ATTITUDE_TARGET into targets.

https://mavlink.io/en/messages/common.html#POSITION_TARGET_TYPEMASK; body frames are level and
turned by the heading: PX4 `mavlink_receiver.cpp` (handle_message_set_position_target_local_ned),
ArduPilot `ArduCopter/GCS_Mavlink.cpp`.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Vec3, from_euler, normalised, rotate, vec, yaw_of
from missionkit.sitl.geodetic import GeographicPoint
from missionkit.sitl.mission_progress import RELATIVE_FRAMES
from missionkit.sitl.pymavlink_dialect import Message, mavlink
from missionkit.sitl.setpoint_tracking import NO_AXES, Axes, SetpointTarget
from missionkit.sitl.sitl_state import SitlState

BODY_FRAMES = (
    mavlink.MAV_FRAME_BODY_NED,
    mavlink.MAV_FRAME_BODY_OFFSET_NED,
    mavlink.MAV_FRAME_BODY_FRD,
)
OFFSET_FRAMES = (mavlink.MAV_FRAME_LOCAL_OFFSET_NED, mavlink.MAV_FRAME_BODY_OFFSET_NED)
LOCAL = (mavlink.MAV_FRAME_LOCAL_NED, *BODY_FRAMES, mavlink.MAV_FRAME_LOCAL_OFFSET_NED)
YAW_IGNORED, YAW_RATE_IGNORED = 1 << 10, 1 << 11
RATES_IGNORED, ATTITUDE_IGNORED = 7, 1 << 7
THRUST_IS_THRUST = 8  # bit of GUID_OPTIONS: not a climb rate


def read(state: SitlState, message: Message) -> SetpointTarget | None:
    """Return the target a message sets, `None` if it cannot be used."""
    match message.get_type():
        case "SET_POSITION_TARGET_LOCAL_NED" if message.coordinate_frame in LOCAL:
            place = (message.x, message.y, message.z)
            return _target(state, message, place)
        case "SET_POSITION_TARGET_GLOBAL_INT":
            return _target(state, message, _global(state, message))
        case "SET_ATTITUDE_TARGET":
            return _attitude(state, message)
        case _:
            return None


def _global(state: SitlState, message: Message) -> tuple[float, ...]:
    height = message.alt
    if message.coordinate_frame in RELATIVE_FRAMES:
        height += state.earth.origin.height - float(state.home[2])
    spot = GeographicPoint(message.lat_int / 1e7, message.lon_int / 1e7, height)
    return tuple(map(float, state.earth.position(spot)))


def _axes(numbers: tuple[float, ...], mask: int) -> Axes:
    n, e, d = (
        None if mask >> bit & 1 or not math.isfinite(value) else float(value)
        for bit, value in enumerate(numbers)
    )
    return (n, e, d)


def _turned(axes: Axes, frame: int, state: SitlState) -> Axes:
    if frame not in BODY_FRAMES or axes == NO_AXES:
        return axes
    heading = from_euler(0.0, 0.0, yaw_of(state.body.attitude))
    n, e, d = map(float, rotate(heading, vec(*(value or 0.0 for value in axes))))
    level = None if axes[0] is None and axes[1] is None else n
    across = None if level is None else e
    return (level, across, None if axes[2] is None else d)


def _target(state: SitlState, message: Message, place: tuple[float, ...]) -> SetpointTarget | None:
    frame, mask = message.coordinate_frame, message.type_mask
    position = _placed(state, _axes(place, mask), frame)
    velocity = _axes((message.vx, message.vy, message.vz), mask >> 3)
    acceleration = _axes((message.afx, message.afy, message.afz), mask >> 6)
    if NO_AXES == position == velocity == acceleration:
        return None
    return SetpointTarget(
        state.now,
        position,
        _turned(velocity, frame, state),
        _turned(acceleration, frame, state),
        None if mask & YAW_IGNORED or not math.isfinite(message.yaw) else message.yaw,
        None
        if mask & YAW_RATE_IGNORED or not math.isfinite(message.yaw_rate)
        else message.yaw_rate,
    )


def _placed(state: SitlState, position: Axes, frame: int) -> Axes:
    """Turn a position that is relative to the vehicle into one of the local frame."""
    if frame not in {*OFFSET_FRAMES, *BODY_FRAMES} or position == NO_AXES:
        return position
    if state.dialect.name == "px4":
        return NO_AXES  # PX4 takes no positions in these frames
    turned, here = _turned(position, frame, state), state.body.position
    n, e, d = (
        None if value is None else value + float(here[axis]) for axis, value in enumerate(turned)
    )
    return (n, e, d)


def _attitude(state: SitlState, message: Message) -> SetpointTarget | None:
    mask = message.type_mask
    if mask & ATTITUDE_IGNORED and mask & RATES_IGNORED == RATES_IGNORED:
        return None
    if not _usable(message):
        return None
    rates: Vec3 | None = None
    if mask & RATES_IGNORED != RATES_IGNORED:
        numbers = (message.body_roll_rate, message.body_pitch_rate, message.body_yaw_rate)
        rates = vec(*(0.0 if mask >> bit & 1 else value for bit, value in enumerate(numbers)))
    before = state.target.attitude if state.target is not None else None
    if not mask & ATTITUDE_IGNORED:
        attitude = normalised(np.array(message.q, dtype=float))
        rate = 0.0 if rates is None else float(rates[2])
        return _thrust(state, message, SetpointTarget(state.now, attitude=attitude, yaw_rate=rate))
    attitude = state.body.attitude if before is None else before
    return _thrust(state, message, SetpointTarget(state.now, attitude=attitude, rates=rates))


def _usable(message: Message) -> bool:
    rates = (message.body_roll_rate, message.body_pitch_rate, message.body_yaw_rate)
    size = math.hypot(*message.q)
    turned = message.type_mask & ATTITUDE_IGNORED or (math.isfinite(size) and 0.9 < size < 1.1)
    return bool(turned) and all(map(math.isfinite, (*rates, message.thrust)))


def _thrust(state: SitlState, message: Message, target: SetpointTarget) -> SetpointTarget:
    """Take the thrust; in ArduPilot it is a climb rate unless GUID_OPTIONS says otherwise."""
    if state.dialect.name == "px4" or int(state.parameters["GUID_OPTIONS"]) & THRUST_IS_THRUST:
        return target._replace(thrust=max(0.0, min(1.0, message.thrust)))
    fastest = state.parameters["WPNAV_SPEED_UP"] / 100.0
    climb = 2.0 * (max(0.0, min(1.0, message.thrust)) - 0.5) * fastest
    hover = 1.0 / state.body.world.quadrotor.thrust_to_weight
    return target._replace(thrust=hover, velocity=(None, None, -climb))
