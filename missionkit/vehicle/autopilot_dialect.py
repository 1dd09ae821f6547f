"""PX4 and ArduPilot as data: what differs between them on the wire.

Sources: MAVLink common.xml; PX4 `px4_custom_mode.h` and `commander`; ArduCopter `mode.h`,
`GCS_Mavlink.cpp`. Custom modes of PX4 are `sub << 24 | main << 16`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from missionkit.vehicle.failsafe_parameters import (
    ARDUPILOT_FAILSAFES,
    ARDUPILOT_THRESHOLDS,
    PX4_FAILSAFES,
    PX4_THRESHOLDS,
    FailsafeParameter,
    FailsafeThresholds,
)

AUTOPILOT_ARDUPILOT = 3  # MAV_AUTOPILOT
AUTOPILOT_PX4 = 12

# POSITION_TARGET_TYPEMASK and ATTITUDE_TARGET_TYPEMASK: the bits set are ignored
VELOCITY_MASK = 0x5C7  # type_mask: velocity and yaw rate count
CMD_ARM, CMD_SET_MODE = 400, 176  # MAV_CMD
AUTOPILOT_COMPONENT = 1  # MAV_COMP_ID_AUTOPILOT1
POSITION_MASK = 0x9F8  # position and yaw count
ATTITUDE_MASK = 0x07  # attitude and thrust count
LOCAL_NED, BODY_FRD = 1, 12  # MAV_FRAME


class Dialect(NamedTuple):
    """Commands that one autopilot expects, and the meaning of its modes."""

    name: str
    modes: Mapping[int, str]  # custom mode -> name in the mission; see VehicleStatus
    hold: tuple[float, float, float]  # parameters of DO_SET_MODE
    offboard: tuple[float, float, float]
    land: tuple[float, float, float] | None  # None: NAV_LAND
    precise: tuple[float, float, float]  # to land on LANDING_TARGET
    precise_word: str  # name of the mode in which it does
    precise_parameters: tuple[str, ...]  # that must be set for it
    offboard_word: str  # name of the mode in which setpoints are obeyed
    hold_word: str  # name of the mode in which the vehicle holds
    warm: float  # s of setpoints before it enters that mode
    early: bool  # whether setpoints may be sent while it takes off
    takeoff_param: str | None  # parameter for the height, None: within the command
    checks_present: bool  # whether SYS_STATUS names its arming checks among what is there
    loss: tuple[str, float]  # parameter for the time (s) without setpoints, and its default
    failsafes: tuple[FailsafeParameter, ...]
    thresholds: tuple[FailsafeThresholds, ...]
    intervals: Mapping[int, float]  # message id -> Hz
    sphere: float  # m, radius of the earth in its simulators
    target_frame: int  # MAV_FRAME in which it takes LANDING_TARGET
    leash: float | None  # m, most distance to a position setpoint; None: its timeout covers them


INTERVALS: Mapping[int, float] = {
    0: 5.0,  # HEARTBEAT: mode and arming come with it; those that cannot stay at 1 Hz
    24: 5.0,  # GPS_RAW_INT
    31: 50.0,  # ATTITUDE_QUATERNION
    32: 20.0,  # LOCAL_POSITION_NED
    105: 250.0,  # HIGHRES_IMU, every sample: PX4's are means since the one before
    49: 0.5,  # GPS_GLOBAL_ORIGIN: where the local frame begins
    100: 20.0,  # OPTICAL_FLOW
    106: 20.0,  # OPTICAL_FLOW_RAD
    115: 50.0,  # HIL_STATE_QUATERNION, from simulators only
    124: 5.0,  # GPS2_RAW
    132: 20.0,  # DISTANCE_SENSOR
    147: 2.0,  # BATTERY_STATUS
    242: 1.0,  # HOME_POSITION
    245: 5.0,  # EXTENDED_SYS_STATE
    330: 10.0,  # OBSTACLE_DISTANCE
    331: 50.0,  # ODOMETRY
    350: 20.0,  # DEBUG_FLOAT_ARRAY: ground robots, from missionkit's simulator only
    1: 2.0,  # SYS_STATUS
    2: 1.0,  # SYSTEM_TIME
}
SCALED: Mapping[int, float] = {
    **{ident: rate for ident, rate in INTERVALS.items() if ident != 105},
    27: 100.0,  # RAW_IMU
    29: 10.0,  # SCALED_PRESSURE
}
GIMBAL_INTERVALS: Mapping[int, float] = {
    285: 20.0
}  # GIMBAL_DEVICE_ATTITUDE_STATUS, if there is one
OPTIONAL = frozenset(
    (0, 2, 49, 100, 106, 115, 124, 132, 285, 330, 331, 350)
)  # nothing is missing without these


def _px4(main: int, sub: int = 0) -> int:
    return sub << 24 | main << 16


PX4 = Dialect(
    name="PX4",
    modes={
        _px4(1): "manual",
        _px4(2): "altitude",
        _px4(3): "position",
        _px4(4, 1): "ready",
        _px4(4, 2): "take_off",
        _px4(4, 3): "hold",
        _px4(4, 4): "mission",
        _px4(4, 5): "return",
        _px4(4, 6): "land",
        _px4(4, 8): "follow",
        _px4(4, 9): "precision_land",
        _px4(5): "acro",
        _px4(6): "offboard",
        _px4(7): "stabilized",
    },
    hold=(1.0, 4.0, 3.0),
    offboard=(1.0, 6.0, 0.0),
    land=None,
    precise=(1.0, 4.0, 9.0),
    precise_word="precision_land",
    precise_parameters=(),
    offboard_word="offboard",
    hold_word="hold",
    warm=1.0,
    early=True,
    takeoff_param="MIS_TAKEOFF_ALT",
    checks_present=False,
    loss=("COM_OF_LOSS_T", 1.0),
    failsafes=PX4_FAILSAFES,
    thresholds=PX4_THRESHOLDS,
    intervals=INTERVALS,
    sphere=6371000.0,  # CONSTANTS_RADIUS_OF_EARTH
    target_frame=LOCAL_NED,
    leash=None,
)

GUIDED_MODE = "guided"  # taking off, holding and following setpoints are one mode of ArduCopter

ARDUPILOT = Dialect(
    name="ArduPilot",
    modes={
        0: "stabilized",
        1: "acro",
        2: "altitude",
        3: "mission",
        4: GUIDED_MODE,
        5: "loiter",
        6: "return",
        7: "circle",
        9: "land",
        11: "drift",
        13: "sport",
        14: "flip",
        16: "position",
        17: "brake",
        18: "throw",
        20: "guided_nogps",
        21: "smart_return",
    },
    hold=(1.0, 4.0, 0.0),  # not BRAKE, which refuses to arm
    offboard=(1.0, 4.0, 0.0),
    land=(1.0, 9.0, 0.0),
    precise=(1.0, 9.0, 0.0),
    precise_word="land",
    precise_parameters=("PLND_ENABLED", "PLND_TYPE"),
    offboard_word=GUIDED_MODE,
    hold_word=GUIDED_MODE,
    warm=0.0,
    early=False,  # a setpoint would end the take-off
    takeoff_param=None,
    checks_present=True,
    loss=("GUID_TIMEOUT", 3.0),
    failsafes=ARDUPILOT_FAILSAFES,
    thresholds=ARDUPILOT_THRESHOLDS,
    intervals=SCALED,  # few of its versions know HIGHRES_IMU
    sphere=6378100.0,  # RADIUS_OF_EARTH, as in LOCATION_SCALING_FACTOR
    target_frame=BODY_FRD,
    leash=2.0,  # GUID_TIMEOUT does not count for positions: it would fly on to one unheard
)

DIALECTS: Mapping[int, Dialect] = {AUTOPILOT_PX4: PX4, AUTOPILOT_ARDUPILOT: ARDUPILOT}


def dialect_of(autopilot: int) -> Dialect | None:
    """Return the dialect of a heartbeat's `autopilot` field, None if we do not speak it."""
    return DIALECTS.get(autopilot)


def word(dialect: Dialect, custom_mode: int) -> str:
    """Return the mission's word for a mode.

    >>> word(PX4, 6 << 16)
    'offboard'
    """
    return dialect.modes.get(custom_mode, f"mode_{custom_mode:x}")
