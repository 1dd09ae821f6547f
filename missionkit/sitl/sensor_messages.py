"""Messages about motion and sensors.

Frames and units: https://mavlink.io/en/messages/common.html. Times are µs or ms since boot; those
of sensors are when the measurement was valid. The autopilot's own position and velocity carry the
errors of the simulated inner autopilot; its attitude and rates are exact.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import GRAVITY, conjugate, norm, rotate, to_euler, to_matrix, vec, yaw_of
from missionkit.messages import Gnss
from missionkit.sitl.geodetic import e7
from missionkit.sitl.pymavlink_dialect import Message, mavlink
from missionkit.sitl.sitl_state import SitlState

NAN = math.nan
FIELD = 0.5  # gauss, of the Earth
INERTIAL_UPDATED, MAGNETIC_UPDATED, BAROMETRIC_UPDATED = 0x3F, 0x1C0, 0x1A00
"""HIGHRES_IMU_UPDATED_FLAGS."""
RING_SECTORS = 72
DISTANCE_UNKNOWN = 65535  # UINT16_MAX: not known
PRESSURE, SCALE_HEIGHT = 1013.25, 8434.5  # hPa at sea level, m


def attitude(state: SitlState) -> Message:
    """Return ATTITUDE."""
    roll, pitch, yaw = to_euler(state.body.attitude)
    p, q, r = state.body.rates
    return mavlink.MAVLink_attitude_message(state.micros // 1000, roll, pitch, yaw, p, q, r)


def attitude_quaternion(state: SitlState) -> Message:
    """Return ATTITUDE_QUATERNION."""
    return mavlink.MAVLink_attitude_quaternion_message(
        state.micros // 1000, *state.body.attitude, *state.body.rates
    )


def local_position_ned(state: SitlState) -> Message:
    """Return LOCAL_POSITION_NED."""
    return mavlink.MAVLink_local_position_ned_message(
        state.micros // 1000, *state.body.position, *state.body.velocity
    )


def hil_state_quaternion(state: SitlState) -> Message:
    """Return HIL_STATE_QUATERNION: the truth, which PX4 streams where it simulates the vehicle.

    PX4 (`streams/HIL_STATE_QUATERNION.hpp`) leaves its stamp zero.
    """
    truth = state.body.truth
    spot = state.earth.spot(truth.position)
    velocity = [round(100.0 * float(each)) for each in truth.velocity]  # cm/s
    return mavlink.MAVLink_hil_state_quaternion_message(
        0,
        list(truth.attitude),
        *truth.rates,
        e7(spot.latitude),
        e7(spot.longitude),
        round(1e3 * spot.height),
        *velocity,
        *(0, 0, 0, 0, 0),
    )


def _heading(state: SitlState) -> float:
    return math.degrees(to_euler(state.body.attitude)[2]) % 360.0


def global_position_int(state: SitlState) -> Message:
    """Return GLOBAL_POSITION_INT."""
    position, velocity = state.body.position, state.body.velocity
    spot = state.earth.spot(position)
    return mavlink.MAVLink_global_position_int_message(
        state.micros // 1000,
        e7(spot.latitude),
        e7(spot.longitude),
        round(1e3 * spot.height),
        round(1e3 * (state.home[2] - position[2])),
        *(round(100.0 * float(v)) for v in velocity),
        round(100.0 * _heading(state)) % 36000,
    )


def altitude(state: SitlState) -> Message:
    """Return ALTITUDE."""
    up = -float(state.body.position[2])
    high = state.earth.origin.height + up
    above_home = up + float(state.home[2])
    return mavlink.MAVLink_altitude_message(state.micros, high, high, up, above_home, up, NAN)


def odometry(state: SitlState) -> Message:
    """Return ODOMETRY: pose in the local frame, velocity in the body's."""
    body = state.body
    moving = rotate(conjugate(body.attitude), body.velocity)
    unknown = (NAN, *(0.0,) * 20)
    return mavlink.MAVLink_odometry_message(
        state.micros,
        mavlink.MAV_FRAME_LOCAL_NED,
        mavlink.MAV_FRAME_BODY_FRD,
        *body.position,
        body.attitude,
        *moving,
        *body.rates,
        unknown,
        unknown,
        0,
        mavlink.MAV_ESTIMATOR_TYPE_AUTOPILOT,
        0 if state.gnss_lost else 100,
    )


def _pressure(state: SitlState) -> tuple[float, float]:
    """Return pressure (hPa) and the height above the sea it means (m)."""
    baro = state.sensed.baro
    high = state.earth.origin.height + (0.0 if baro is None else baro.height)
    return PRESSURE * math.exp(-high / SCALE_HEIGHT), high


def highres_imu(state: SitlState) -> Message:
    """Return HIGHRES_IMU, with magnetometer (gauss) and barometer."""
    imu, mag = state.sensed.imu, state.sensed.mag
    field = vec(0.0, 0.0, 0.0) if mag is None else FIELD * mag.field
    pressure, high = _pressure(state)
    at = state.since_boot(imu.at)
    return mavlink.MAVLink_highres_imu_message(
        at, *imu.accel, *imu.gyro, *field, pressure, 0.0, high, 20.0, INERTIAL_UPDATED
    )


def updated(state: SitlState, last_sent: tuple[float, float]) -> tuple[int, tuple[float, float]]:
    """Return HIGHRES_IMU_UPDATED_FLAGS, and the times of field and pressure that it tells.

    Args:
        state: all that is known.
        last_sent: times (s) when each was last sent.
    """
    mag, baro = state.sensed.mag, state.sensed.baro
    times = (-1.0 if mag is None else mag.at, -1.0 if baro is None else baro.at)
    field = MAGNETIC_UPDATED if times[0] > last_sent[0] else 0
    return INERTIAL_UPDATED | field | (BAROMETRIC_UPDATED if times[1] > last_sent[1] else 0), times


def _milli(state: SitlState) -> list[int]:
    """Return accelerations (mG), rates (mrad/s) and field (mgauss)."""
    imu, mag = state.sensed.imu, state.sensed.mag
    field = vec(0.0, 0.0, 0.0) if mag is None else FIELD * mag.field
    rows = np.concatenate((imu.accel / GRAVITY, imu.gyro, field))
    return [int(value) for value in np.clip(np.rint(1e3 * rows), -32768, 32767)]


def raw_imu(state: SitlState) -> Message:
    """Return RAW_IMU."""
    return mavlink.MAVLink_raw_imu_message(state.since_boot(state.sensed.imu.at), *_milli(state))


def scaled_imu(state: SitlState) -> Message:
    """Return SCALED_IMU."""
    at = state.since_boot(state.sensed.imu.at) // 1000
    return mavlink.MAVLink_scaled_imu_message(at, *_milli(state))


def scaled_pressure(state: SitlState) -> Message:
    """Return SCALED_PRESSURE."""
    return mavlink.MAVLink_scaled_pressure_message(
        state.micros // 1000, _pressure(state)[0], 0.0, 2000
    )


def gps_raw_int(state: SitlState) -> Message | None:
    """Return GPS_RAW_INT; its time is when the fix was valid."""
    fix = state.sensed.gnss
    if fix is None or state.gnss_lost:
        return mavlink.MAVLink_gps_raw_int_message(
            state.micros,
            mavlink.GPS_FIX_TYPE_NO_FIX,
            0,
            0,
            0,
            DISTANCE_UNKNOWN,
            DISTANCE_UNKNOWN,
            DISTANCE_UNKNOWN,
            DISTANCE_UNKNOWN,
            0,
        )
    spot = state.earth.spot(fix.position)
    height = round(1e3 * spot.height)
    return mavlink.MAVLink_gps_raw_int_message(
        state.since_boot(fix.at),
        mavlink.GPS_FIX_TYPE_3D_FIX,
        e7(spot.latitude),
        e7(spot.longitude),
        height,
        80,
        120,
        *_ground_track(fix),
        14,
        height,
        *_accuracy(fix),
    )


def _ground_track(fix: Gnss) -> tuple[int, int]:
    """Return speed (cm/s) and course (cdeg) over ground."""
    if fix.velocity is None:
        return DISTANCE_UNKNOWN, DISTANCE_UNKNOWN
    north, east = float(fix.velocity[0]), float(fix.velocity[1])
    course = math.degrees(math.atan2(east, north)) % 360.0
    return round(100.0 * math.hypot(north, east)), round(100.0 * course) % 36000


def _accuracy(fix: Gnss) -> tuple[int, int, int, int]:
    """Return accuracies of place, height (mm), speed (mm/s) and heading (1e-5 deg, unknown)."""
    level = norm(vec(fix.position_sd[0], fix.position_sd[1], 0.0))
    return (
        round(1e3 * level),
        round(1e3 * fix.position_sd[2]),
        round(1e3 * float(np.max(fix.velocity_sd))),
        0,
    )


def battery_status(state: SitlState) -> Message | None:
    """Return BATTERY_STATUS, four cells as one."""
    reading = state.sensed.battery
    if reading is None:
        return None
    current = state.body.power / reading.voltage
    return mavlink.MAVLink_battery_status_message(
        0,
        mavlink.MAV_BATTERY_FUNCTION_ALL,
        mavlink.MAV_BATTERY_TYPE_LIPO,
        32767,
        [round(1e3 * reading.voltage), *(DISTANCE_UNKNOWN,) * 9],
        round(100.0 * current),
        -1,
        round(state.body.truth.energy / 100.0),
        round(100.0 * reading.charge),
        0,
        _charge_state(reading.charge),
    )


def _charge_state(charge: float) -> int:
    for most, name in ((0.05, "EMERGENCY"), (0.07, "CRITICAL"), (0.15, "LOW")):
        if charge < most:
            return int(getattr(mavlink, f"MAV_BATTERY_CHARGE_STATE_{name}"))
    return int(mavlink.MAV_BATTERY_CHARGE_STATE_OK)


def obstacle_distance(state: SitlState) -> Message | None:
    """Return OBSTACLE_DISTANCE: 72 sectors of 5 degrees, clockwise from straight ahead."""
    scan, reach = state.sensed.scan, state.body.world.sensors.scan.range
    if scan is None:
        return None
    far = round(100.0 * reach)
    distances = [far + 1] * RING_SECTORS
    ahead = yaw_of(state.body.attitude)
    for n, e, _ in scan.points @ to_matrix(state.body.attitude).T:
        sector = round(math.degrees(math.atan2(e, n) - ahead) / 5.0) % RING_SECTORS
        distances[sector] = min(distances[sector], round(100.0 * math.hypot(n, e)))
    return mavlink.MAVLink_obstacle_distance_message(
        state.since_boot(scan.at),
        mavlink.MAV_DISTANCE_SENSOR_LASER,
        distances,
        5,
        20,
        far,
        5.0,
        0.0,
        mavlink.MAV_FRAME_BODY_FRD,
    )


def measured_at(state: SitlState, number: int) -> float | None:
    """Return the time (s) of the measurement that a message is about."""
    sensed = state.sensed
    if number == mavlink.MAVLINK_MSG_ID_GPS_RAW_INT and state.gnss_lost:
        return math.ceil(state.now)
    made = {
        mavlink.MAVLINK_MSG_ID_HIGHRES_IMU: sensed.imu,
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: sensed.gnss,
        mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: sensed.battery,
        mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE: sensed.scan,
        mavlink.MAVLINK_MSG_ID_OPTICAL_FLOW: sensed.flow,
        mavlink.MAVLINK_MSG_ID_OPTICAL_FLOW_RAD: sensed.flow,
    }[number]
    return None if made is None else made.at
