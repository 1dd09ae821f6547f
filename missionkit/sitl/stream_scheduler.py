"""Which messages go out by themselves, and how often.

PX4 sends the streams of a link (`src/modules/mavlink/mavlink_main.cpp`, MAVLINK_MODE_ONBOARD) as
soon as there is a peer. ArduPilot sends heartbeats, and everything else only when asked for, with
SET_MESSAGE_INTERVAL or the groups of REQUEST_DATA_STREAM (`ArduCopter/GCS_Mavlink.cpp`, SRn_*).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from missionkit.sitl import (
    flow_range_messages,
    gimbal_manager,
    health_messages,
    robot_messages,
    sensor_messages,
    status_messages,
)
from missionkit.sitl.peer_channel import Channel, StreamSchedule
from missionkit.sitl.pymavlink_dialect import Message, mavlink
from missionkit.sitl.sitl_state import SitlState

HEARTBEAT_ID = mavlink.MAVLINK_MSG_ID_HEARTBEAT
FASTEST_STREAM = 100.0  # Hz: the inertial unit's rate

Builder = Callable[[SitlState], Message | None]
MESSAGE_BUILDERS: Mapping[int, Builder] = {
    HEARTBEAT_ID: status_messages.heartbeat,
    mavlink.MAVLINK_MSG_ID_SYS_STATUS: health_messages.sys_status,
    mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS: health_messages.estimator_status,
    mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT: health_messages.ekf_status_report,
    mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: status_messages.extended_sys_state,
    mavlink.MAVLINK_MSG_ID_HOME_POSITION: status_messages.home_position,
    mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: status_messages.gps_global_origin,
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: status_messages.system_time,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: status_messages.mission_current,
    mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION: status_messages.autopilot_version,
    mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET: status_messages.attitude_target,
    mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: status_messages.position_target,
    mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: status_messages.nav_controller_output,
    mavlink.MAVLINK_MSG_ID_VFR_HUD: status_messages.vfr_hud,
    mavlink.MAVLINK_MSG_ID_ATTITUDE: sensor_messages.attitude,
    mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: sensor_messages.attitude_quaternion,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: sensor_messages.local_position_ned,
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: sensor_messages.global_position_int,
    mavlink.MAVLINK_MSG_ID_ALTITUDE: sensor_messages.altitude,
    mavlink.MAVLINK_MSG_ID_ODOMETRY: sensor_messages.odometry,
    mavlink.MAVLINK_MSG_ID_HIL_STATE_QUATERNION: sensor_messages.hil_state_quaternion,
    mavlink.MAVLINK_MSG_ID_HIGHRES_IMU: sensor_messages.highres_imu,
    mavlink.MAVLINK_MSG_ID_RAW_IMU: sensor_messages.raw_imu,
    mavlink.MAVLINK_MSG_ID_SCALED_IMU: sensor_messages.scaled_imu,
    mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE: sensor_messages.scaled_pressure,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: sensor_messages.gps_raw_int,
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: sensor_messages.battery_status,
    mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE: sensor_messages.obstacle_distance,
    mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR: flow_range_messages.distance_sensor,
    mavlink.MAVLINK_MSG_ID_OPTICAL_FLOW: flow_range_messages.optical_flow,
    mavlink.MAVLINK_MSG_ID_OPTICAL_FLOW_RAD: flow_range_messages.optical_flow_rad,
    mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS: gimbal_manager.attitude_status,
    mavlink.MAVLINK_MSG_ID_DEBUG_FLOAT_ARRAY: robot_messages.debug_float_array,
}
FRESH_ONLY = frozenset(  # sent once for each measurement, even if requested more often
    (
        mavlink.MAVLINK_MSG_ID_HIGHRES_IMU,
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT,
        mavlink.MAVLINK_MSG_ID_BATTERY_STATUS,
        mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE,
        mavlink.MAVLINK_MSG_ID_OPTICAL_FLOW,
        mavlink.MAVLINK_MSG_ID_OPTICAL_FLOW_RAD,
    )
)
MISSING_MESSAGES = {  # what the real one does not have
    "px4": frozenset(
        (mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT, mavlink.MAVLINK_MSG_ID_OPTICAL_FLOW)
    ),
    "ardupilot": frozenset(
        (
            mavlink.MAVLINK_MSG_ID_HIGHRES_IMU,
            mavlink.MAVLINK_MSG_ID_ODOMETRY,
            mavlink.MAVLINK_MSG_ID_ALTITUDE,
            mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS,
            mavlink.MAVLINK_MSG_ID_OPTICAL_FLOW_RAD,
            mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE,  # passed on from the sensor, never requested
        )
    ),
}

DEFAULT_RATES: Mapping[str, Mapping[int, float]] = {  # Hz, sent by default
    "px4": {
        HEARTBEAT_ID: 1.0,
        mavlink.MAVLINK_MSG_ID_SYS_STATUS: 5.0,
        mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS: 1.0,
        mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: 5.0,
        mavlink.MAVLINK_MSG_ID_HOME_POSITION: 0.5,
        mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: 1.0,
        mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: 1.0,
        mavlink.MAVLINK_MSG_ID_ATTITUDE: 50.0,
        mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: 50.0,
        mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: 30.0,
        mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 50.0,
        mavlink.MAVLINK_MSG_ID_ALTITUDE: 10.0,
        mavlink.MAVLINK_MSG_ID_ODOMETRY: 30.0,
        mavlink.MAVLINK_MSG_ID_HIGHRES_IMU: 50.0,
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: 5.0,
        mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: 1.0,
        mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE: 10.0,
        mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR: 10.0,
        mavlink.MAVLINK_MSG_ID_OPTICAL_FLOW_RAD: 10.0,
        mavlink.MAVLINK_MSG_ID_VFR_HUD: 10.0,
    },
    "ardupilot": {HEARTBEAT_ID: 1.0, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE: 10.0},
}
STREAM_GROUPS: Mapping[int, tuple[int, ...]] = {  # MAV_DATA_STREAM, as ArduCopter fills them
    mavlink.MAV_DATA_STREAM_RAW_SENSORS: (
        mavlink.MAVLINK_MSG_ID_RAW_IMU,
        mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE,
    ),
    mavlink.MAV_DATA_STREAM_EXTENDED_STATUS: (
        mavlink.MAVLINK_MSG_ID_SYS_STATUS,
        mavlink.MAVLINK_MSG_ID_MISSION_CURRENT,
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT,
        mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT,
    ),
    mavlink.MAV_DATA_STREAM_POSITION: (
        mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT,
        mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED,
    ),
    mavlink.MAV_DATA_STREAM_EXTRA1: (mavlink.MAVLINK_MSG_ID_ATTITUDE,),
    mavlink.MAV_DATA_STREAM_EXTRA2: (mavlink.MAVLINK_MSG_ID_VFR_HUD,),
    mavlink.MAV_DATA_STREAM_EXTRA3: (
        mavlink.MAVLINK_MSG_ID_SYSTEM_TIME,
        mavlink.MAVLINK_MSG_ID_BATTERY_STATUS,
        mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR,
        mavlink.MAVLINK_MSG_ID_OPTICAL_FLOW,
        mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT,
    ),
}


class Messages:
    """Messages of this moment, each built once however many peers want it."""

    def __init__(self) -> None:
        self._made: dict[int, Message | None] = {}
        self._kept: dict[int, tuple[float | None, Message | None]] = {}

    def forget(self) -> None:
        """Let the moment pass."""
        self._made.clear()

    def get(self, state: SitlState, number: int) -> Message | None:
        """Return the message with that id, `None` when there is nothing to say."""
        if number not in self._made:
            self._made[number] = self._fresh(state, number)
        return self._made[number]

    def _fresh(self, state: SitlState, number: int) -> Message | None:
        if number not in FRESH_ONLY:
            return MESSAGE_BUILDERS[number](state)
        at = sensor_messages.measured_at(state, number)
        before, message = self._kept.get(number, (None, None))
        if at != before or message is None:
            message = MESSAGE_BUILDERS[number](state)
            self._kept[number] = (at, message)
        return message


def known(state: SitlState, number: int) -> bool:
    """Tell whether this autopilot has that message."""
    return number in MESSAGE_BUILDERS and number not in MISSING_MESSAGES[state.dialect.name]


def begin(state: SitlState, channel: Channel) -> None:
    """Set the rates of a link to those it has after a start."""
    channel.streams = {
        number: StreamSchedule(1.0 / rate, state.now)
        for number, rate in DEFAULT_RATES[state.dialect.name].items()
    }
    channel.streams[HEARTBEAT_ID] = StreamSchedule(state.heartbeat, state.now)


def ask(state: SitlState, channel: Channel, number: int, interval: float) -> bool:
    """Change the interval (s) of a stream, 0: as after a start, less: off; return whether it can.

    The heartbeat stays as it is.

    Args:
        state: of the autopilot.
        channel: whose streams are changed; other channels keep theirs.
        number: id of the message.
        interval: s.
    """
    if not known(state, number) or number == HEARTBEAT_ID:
        return False
    usual = DEFAULT_RATES[state.dialect.name].get(number)
    if interval == 0.0 and usual is not None:
        interval = 1.0 / usual
    if interval <= 0.0:
        channel.streams.pop(number, None)
    else:
        channel.streams[number] = StreamSchedule(max(interval, 1.0 / FASTEST_STREAM), state.now)
    return True


def ask_group(state: SitlState, channel: Channel, group: int, rate: float) -> None:
    """Set the rate (Hz) of a group of ArduPilot's streams, 0: off.

    Args:
        state: of the autopilot.
        channel: whose streams are changed.
        group: MAV_DATA_STREAM; an unknown one is ignored.
        rate: Hz.
    """
    groups = (
        STREAM_GROUPS
        if group == mavlink.MAV_DATA_STREAM_ALL
        else {group: STREAM_GROUPS.get(group, ())}
    )
    for numbers in groups.values():
        for number in numbers:
            ask(state, channel, number, 1.0 / rate if rate > 0 else -1.0)


def send_due(state: SitlState, messages: Messages) -> None:
    """Send what is due on every link; heartbeats only until a peer has sent something."""
    if not state.troubles.active("streams_frozen", state.now):
        messages.forget()
    stopped = state.troubles.active("streams_stopped", state.now) is not None
    lost = (state.troubles.active("stream_lost", state.now) or (None,))[0]
    for channel in state.channels:
        for number, beat in channel.streams.items():
            quiet = number != HEARTBEAT_ID and (stopped or number == lost or not channel.heard)
            if not beat.due(state.now) or quiet:
                continue
            alive = number == HEARTBEAT_ID
            message = status_messages.heartbeat(state) if alive else messages.get(state, number)
            if message is None or (number in FRESH_ONLY and message is beat.last):
                continue
            if number == mavlink.MAVLINK_MSG_ID_HIGHRES_IMU:
                message.fields_updated, beat.sensors_sent = sensor_messages.updated(
                    state, beat.sensors_sent
                )
            beat.last = message
            channel.send(message, state.now)
