"""Messages of the sensors that look down: optical flow and range finder.

PX4 sends OPTICAL_FLOW_RAD (`streams/OPTICAL_FLOW_RAD.hpp`), ArduPilot OPTICAL_FLOW
(`GCS_Common.cpp`, send_opticalflow: its stamp is in ms). Flow about an axis is positive where a
right-handed turn about it is.
"""

from __future__ import annotations

from missionkit.geometry import vec
from missionkit.sitl.pymavlink_dialect import Message, mavlink
from missionkit.sitl.sitl_state import SitlState

BEST = 255  # quality
RANGE_UNKNOWN = -1.0  # m
NO_COVARIANCE = 255


def optical_flow_rad(state: SitlState) -> Message | None:
    """Return OPTICAL_FLOW_RAD: integrals over the interval that ended at its stamp."""
    flow = state.sensed.flow
    if flow is None:
        return None
    x, y = (flow.over * flow.flow).tolist()
    turned = flow.over * (vec(0.0, 0.0, 0.0) if flow.rates is None else flow.rates)
    return mavlink.MAVLink_optical_flow_rad_message(
        state.since_boot(flow.at),
        0,
        round(1e6 * flow.over),
        *(y, -x),
        *turned.tolist(),
        2000,
        round(BEST * flow.quality),
        0,
        _distance(state),
    )


def optical_flow(state: SitlState) -> Message | None:
    """Return OPTICAL_FLOW: rates, and what is left of them without the sensor's own turns."""
    flow = state.sensed.flow
    if flow is None:
        return None
    x, y = flow.flow.tolist()
    p, q, _ = (0.0, 0.0, 0.0) if flow.rates is None else flow.rates.tolist()
    return mavlink.MAVLink_optical_flow_message(
        state.since_boot(flow.at) // 1000,
        0,
        *(int(y), int(-x)),
        *(y - p, -x - q),
        round(BEST * flow.quality),
        max(_distance(state), 0.0),
        *(y, -x),
    )


def distance_sensor(state: SitlState) -> Message:
    """Return DISTANCE_SENSOR, facing down; out of reach it says a distance that is."""
    reading, model = state.sensed.range, state.body.world.sensors.range
    least, most = round(100.0 * model.least), round(100.0 * model.most)
    at, distance = state.now, most + 1 if -state.body.position[2] > model.least else least - 1
    if reading is not None and state.now - reading.at < 1.5 / model.rate:
        at, distance = reading.at, round(100.0 * reading.distance)
    return mavlink.MAVLink_distance_sensor_message(
        state.since_boot(at) // 1000,
        least,
        most,
        distance,
        mavlink.MAV_DISTANCE_SENSOR_LASER,
        0,
        mavlink.MAV_SENSOR_ROTATION_PITCH_270,
        NO_COVARIANCE,
    )


def _distance(state: SitlState) -> float:
    """Return the distance to the ground (m), negative if it is not known."""
    reading, flow = state.sensed.range, state.sensed.flow
    if reading is None or flow is None or abs(flow.at - reading.at) > flow.over:
        return RANGE_UNKNOWN
    return reading.distance
