"""Messages about the autopilot itself: mode, home, plans, targets, version.

https://mavlink.io/en/messages/common.html
"""

from __future__ import annotations

import math

from missionkit.geometry import to_euler, yaw_of
from missionkit.sitl.flight_modes import ARMED_FLAG, CUSTOM_FLAG, FlightTask
from missionkit.sitl.geodetic import e7
from missionkit.sitl.pymavlink_dialect import Message, mavlink
from missionkit.sitl.sitl_state import SitlState

EPOCH = 1_780_000_000_000_000  # µs, made up: GNSS time at the start of every simulation
QUADROTOR = mavlink.MAV_TYPE_QUADROTOR


def heartbeat(state: SitlState) -> Message:
    """Return HEARTBEAT."""
    base = CUSTOM_FLAG | state.mode.base | (ARMED_FLAG if state.armed else 0)
    return mavlink.MAVLink_heartbeat_message(
        QUADROTOR, state.dialect.autopilot, base, state.mode.number, _status(state), 3
    )


def _status(state: SitlState) -> int:
    if state.failsafe:
        return int(mavlink.MAV_STATE_CRITICAL)
    # PX4 says so once armed, ArduPilot once flying; both mean: under power
    return int(mavlink.MAV_STATE_ACTIVE if state.armed else mavlink.MAV_STATE_STANDBY)


def extended_sys_state(state: SitlState) -> Message:
    """Return EXTENDED_SYS_STATE."""
    if not state.in_air:
        landed = mavlink.MAV_LANDED_STATE_ON_GROUND
    elif state.body.truth.mode == "take_off":
        landed = mavlink.MAV_LANDED_STATE_TAKEOFF
    elif state.body.truth.mode == "land":
        landed = mavlink.MAV_LANDED_STATE_LANDING
    else:
        landed = mavlink.MAV_LANDED_STATE_IN_AIR
    return mavlink.MAVLink_extended_sys_state_message(mavlink.MAV_VTOL_STATE_UNDEFINED, landed)


def home_position(state: SitlState) -> Message | None:
    """Return HOME_POSITION, once there is a fix."""
    if state.sensed.gnss is None:
        return None
    spot = state.earth.spot(state.home)
    return mavlink.MAVLink_home_position_message(
        e7(spot.latitude),
        e7(spot.longitude),
        round(1e3 * spot.height),
        *state.home,
        (1.0, 0.0, 0.0, 0.0),
        0.0,
        0.0,
        0.0,
        state.micros,
    )


def gps_global_origin(state: SitlState) -> Message | None:
    """Return GPS_GLOBAL_ORIGIN: where the local frame has its origin."""
    if state.sensed.gnss is None:
        return None
    spot = state.earth.origin
    return mavlink.MAVLink_gps_global_origin_message(
        e7(spot.latitude), e7(spot.longitude), round(1e3 * spot.height), state.micros
    )


def system_time(state: SitlState) -> Message:
    """Return SYSTEM_TIME."""
    return mavlink.MAVLink_system_time_message(EPOCH + round(1e6 * state.now), state.micros // 1000)


def mission_current(state: SitlState) -> Message:
    """Return MISSION_CURRENT."""
    plans = state.plans
    flying = state.mode.does is FlightTask.MISSION
    if not plans.mission:
        stage = mavlink.MISSION_STATE_NO_MISSION
    elif flying and plans.current >= len(plans.mission):
        stage = mavlink.MISSION_STATE_COMPLETE
    elif flying and state.armed:
        stage = mavlink.MISSION_STATE_ACTIVE
    else:
        stage = mavlink.MISSION_STATE_NOT_STARTED
    last = max(0, len(plans.mission) - 1)
    return mavlink.MAVLink_mission_current_message(
        min(plans.current, last), len(plans.mission), stage, 1 if flying else 2
    )


def autopilot_version(state: SitlState) -> Message:
    """Return AUTOPILOT_VERSION."""
    dialect, built = state.dialect, [0] * 8
    return mavlink.MAVLink_autopilot_version_message(
        dialect.capabilities, dialect.version, 0, 0, 0, built, built, built, 0, 0, state.system
    )


def attitude_target(state: SitlState) -> Message | None:
    """Return ATTITUDE_TARGET while an attitude is flown."""
    target = state.target
    if target is None or target.attitude is None:
        return None
    rates = (0.0, 0.0, 0.0) if target.rates is None else target.rates
    return mavlink.MAVLink_attitude_target_message(
        state.micros // 1000, 0, target.attitude, *rates, target.thrust
    )


def position_target(state: SitlState) -> Message | None:
    """Return POSITION_TARGET_LOCAL_NED of the setpoint that is flown."""
    target = state.target
    if target is None or target.attitude is not None:
        return None
    numbers = (*target.position, *target.velocity, *target.acceleration)
    mask = sum(1 << bit for bit, value in enumerate(numbers) if value is None)
    mask |= (1024 if target.yaw is None else 0) | (2048 if target.yaw_rate is None else 0)
    return mavlink.MAVLink_position_target_local_ned_message(
        state.micros // 1000,
        mavlink.MAV_FRAME_LOCAL_NED,
        mask,
        *(value or 0.0 for value in numbers),
        target.yaw or 0.0,
        target.yaw_rate or 0.0,
    )


def vfr_hud(state: SitlState) -> Message:
    """Return VFR_HUD."""
    velocity = state.body.velocity
    speed = math.hypot(velocity[0], velocity[1])
    heading = round(math.degrees(yaw_of(state.body.attitude))) % 360
    high = state.earth.origin.height - float(state.body.position[2])
    return mavlink.MAVLink_vfr_hud_message(
        speed, speed, heading, 50 if state.armed else 0, high, -float(velocity[2])
    )


def nav_controller_output(state: SitlState) -> Message:
    """Return NAV_CONTROLLER_OUTPUT."""
    roll, pitch, yaw = (math.degrees(angle) for angle in to_euler(state.body.attitude))
    return mavlink.MAVLink_nav_controller_output_message(
        roll, pitch, round(yaw), round(yaw), 0, 0.0, 0.0, 0.0
    )
