"""Messages about how well sensors and estimator are.

https://mavlink.io/en/messages/common.html (SYS_STATUS, ESTIMATOR_STATUS, MAV_SYS_STATUS_SENSOR);
https://mavlink.io/en/messages/ardupilotmega.html (EKF_STATUS_REPORT).
"""

from __future__ import annotations

from missionkit.sitl import arming_rules, fence_breach
from missionkit.sitl.pymavlink_dialect import Message, mavlink
from missionkit.sitl.sitl_state import SitlState

SENSOR_HEALTH = (
    mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO
    | mavlink.MAV_SYS_STATUS_SENSOR_3D_ACCEL
    | mavlink.MAV_SYS_STATUS_SENSOR_3D_MAG
    | mavlink.MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE
    | mavlink.MAV_SYS_STATUS_SENSOR_GPS
    | mavlink.MAV_SYS_STATUS_SENSOR_RC_RECEIVER
    | mavlink.MAV_SYS_STATUS_AHRS
    | mavlink.MAV_SYS_STATUS_SENSOR_BATTERY
    | mavlink.MAV_SYS_STATUS_PREARM_CHECK
)
GEOFENCE = mavlink.MAV_SYS_STATUS_GEOFENCE
WITHOUT_POSITION = (  # the bits are the same in ESTIMATOR_STATUS and EKF_STATUS_REPORT
    mavlink.EKF_ATTITUDE
    | mavlink.EKF_VELOCITY_VERT
    | mavlink.EKF_POS_VERT_ABS
    | mavlink.EKF_CONST_POS_MODE
)
WITH_POSITION = (
    mavlink.EKF_ATTITUDE
    | mavlink.EKF_VELOCITY_HORIZ
    | mavlink.EKF_VELOCITY_VERT
    | mavlink.EKF_POS_HORIZ_REL
    | mavlink.EKF_POS_HORIZ_ABS
    | mavlink.EKF_POS_VERT_ABS
    | mavlink.EKF_PRED_POS_HORIZ_REL
    | mavlink.EKF_PRED_POS_HORIZ_ABS
)


def sys_status(state: SitlState) -> Message:
    """Return SYS_STATUS; the bit PREARM_CHECK says whether it could be armed.

    PX4 (`streams/SYS_STATUS.hpp`) sets it in the health alone, ArduPilot in all three fields.
    ArduPilot says GEOFENCE healthy also where there is none (`AC_Fence::sys_status_failed`).
    """
    health, there = SENSOR_HEALTH, SENSOR_HEALTH
    if state.dialect.name == "px4":
        there &= ~mavlink.MAV_SYS_STATUS_PREARM_CHECK
    if state.gnss_lost:
        health &= ~mavlink.MAV_SYS_STATUS_SENSOR_GPS
    if state.troubles.active("rc_lost", state.now):
        health &= ~mavlink.MAV_SYS_STATUS_SENSOR_RC_RECEIVER
    if arming_rules.problems(state):
        health &= ~mavlink.MAV_SYS_STATUS_PREARM_CHECK
    if state.dialect.name == "ardupilot":
        fenced = GEOFENCE if state.parameters["FENCE_ENABLE"] else 0
        there, health = there | fenced, health | (0 if fence_breach.breached(state) else GEOFENCE)
    reading = state.sensed.battery
    volts = 0.0 if reading is None else reading.voltage
    charge = -1 if reading is None else round(100.0 * reading.charge)
    current = round(100.0 * state.body.power / volts) if volts else -1
    return mavlink.MAVLink_sys_status_message(
        there, there, health, 200, round(1e3 * volts), current, charge, 0, 0, 0, 0, 0, 0
    )


def _estimate(state: SitlState) -> tuple[int, float]:
    """Return the flags of the estimator, and its position innovation over what it allows.

    After a start on the ground it has a position once it could be armed, as clients expect.
    """
    starting = arming_rules.is_warming_up(state) and not state.in_air
    known = (state.sensed.gnss is not None or state.by_flow) and not state.blind and not starting
    return (WITH_POSITION if known else WITHOUT_POSITION), (1.5 if state.gnss_lost else 0.1)


def estimator_status(state: SitlState) -> Message:
    """Return PX4's ESTIMATOR_STATUS."""
    flags, ratio = _estimate(state)
    away = 3.0 if state.blind else 0.5  # m
    return mavlink.MAVLink_estimator_status_message(
        state.micros, flags, 0.1, ratio, 0.1, 0.1, 0.0, 0.0, away, away
    )


def ekf_status_report(state: SitlState) -> Message:
    """Return ArduPilot's EKF_STATUS_REPORT."""
    flags, ratio = _estimate(state)
    return mavlink.MAVLink_ekf_status_report_message(flags, 0.1, ratio, 0.1, 0.1, 0.0)
