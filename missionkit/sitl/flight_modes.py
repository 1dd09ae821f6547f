"""The flight modes of both autopilots, as data.

Sources: PX4 `src/modules/commander/px4_custom_mode.h`, `ModeUtil/mode_requirements.cpp`;
ArduPilot `ArduCopter/mode.h` (`Mode::Number`, `allows_arming`), MAVLink COPTER_MODE.
"""

from __future__ import annotations

from enum import StrEnum, auto
from typing import NamedTuple

from missionkit.errors import UsageError, nearest
from missionkit.sitl.pymavlink_dialect import mavlink

CUSTOM_FLAG, AUTO_FLAG, GUIDED_FLAG = 1, 4, 8  # MAV_MODE_FLAG
STABILIZE_FLAG, MANUAL_FLAG, ARMED_FLAG = 16, 64, 128


class FlightTask(StrEnum):
    """Behaviour of the vehicle in a mode. A pilot's sticks are centred: it hovers."""

    PILOT = auto()
    COMMANDED = auto()
    TAKE_OFF = auto()
    HOLD = auto()
    MISSION = auto()
    RETURN = auto()
    LAND = auto()


class FlightMode(NamedTuple):
    """One flight mode of an autopilot."""

    name: str
    number: int  # custom_mode
    does: FlightTask
    arming: bool = True  # may be armed in
    base: int = STABILIZE_FLAG | MANUAL_FLAG  # MAV_MODE_FLAG, besides CUSTOM_FLAG and ARMED_FLAG
    needs_position: bool = True


def _px4(main: int, sub: int = 0) -> int:
    return sub << 24 | main << 16


_SELF = STABILIZE_FLAG | GUIDED_FLAG | AUTO_FLAG
PX4_MODES = (
    FlightMode("MANUAL", _px4(1), FlightTask.PILOT, base=MANUAL_FLAG, needs_position=False),
    FlightMode("ALTCTL", _px4(2), FlightTask.PILOT, needs_position=False),
    FlightMode(
        "POSCTL", _px4(3), FlightTask.PILOT, base=STABILIZE_FLAG | GUIDED_FLAG | MANUAL_FLAG
    ),
    FlightMode("ACRO", _px4(5), FlightTask.PILOT, base=MANUAL_FLAG, needs_position=False),
    FlightMode("OFFBOARD", _px4(6), FlightTask.COMMANDED, base=_SELF),
    FlightMode("STABILIZED", _px4(7), FlightTask.PILOT, needs_position=False),
    FlightMode("TAKEOFF", _px4(4, 2), FlightTask.TAKE_OFF, base=_SELF),
    FlightMode("LOITER", _px4(4, 3), FlightTask.HOLD, base=_SELF),
    FlightMode("MISSION", _px4(4, 4), FlightTask.MISSION, base=_SELF),
    FlightMode("RTL", _px4(4, 5), FlightTask.RETURN, arming=False, base=_SELF),
    FlightMode("LAND", _px4(4, 6), FlightTask.LAND, arming=False, base=_SELF, needs_position=False),
    FlightMode("PRECLAND", _px4(4, 9), FlightTask.LAND, arming=False, base=_SELF),
    FlightMode("ORBIT", _px4(3, 1), FlightTask.HOLD, arming=False, base=_SELF),
)

_ALONE = STABILIZE_FLAG | GUIDED_FLAG | MANUAL_FLAG
ARDUPILOT_MODES = (
    FlightMode("STABILIZE", 0, FlightTask.PILOT, needs_position=False),
    FlightMode("ACRO", 1, FlightTask.PILOT, needs_position=False),
    FlightMode("ALT_HOLD", 2, FlightTask.PILOT, needs_position=False),
    FlightMode("AUTO", 3, FlightTask.MISSION, arming=False, base=_ALONE),
    FlightMode("GUIDED", 4, FlightTask.COMMANDED, base=_ALONE),
    FlightMode("LOITER", 5, FlightTask.PILOT, base=_ALONE),
    FlightMode("RTL", 6, FlightTask.RETURN, arming=False, base=_ALONE),
    FlightMode("LAND", 9, FlightTask.LAND, arming=False, needs_position=False),
    FlightMode("POSHOLD", 16, FlightTask.PILOT, base=_ALONE),
    FlightMode("BRAKE", 17, FlightTask.HOLD, arming=False, base=_ALONE),
    FlightMode("SMART_RTL", 21, FlightTask.RETURN, arming=False, base=_ALONE),
)


class ModeTable(NamedTuple):
    """Differences between the autopilots on the wire."""

    name: str
    autopilot: int  # MAV_AUTOPILOT
    modes: tuple[FlightMode, ...]
    initial: FlightMode
    bytewise: bool  # integer parameters keep their bytes, PX4; else their value
    capabilities: int
    version: int  # flight_sw_version

    def mode(self, number: int) -> FlightMode | None:
        """Return the mode with that custom_mode."""
        return next((mode for mode in self.modes if mode.number == number), None)

    def named(self, name: str) -> FlightMode:
        """Return the mode with that name, in any case.

        Raises:
            UsageError: there is none.
        """
        for mode in self.modes:
            if mode.name == name.upper():
                return mode
        hint = nearest(name.upper(), [mode.name for mode in self.modes])
        raise UsageError(f"{self.name} has no mode {name!r}: {hint}")

    def doing(self, flight: FlightTask) -> FlightMode:
        """Return the first mode that does so."""
        return next(mode for mode in self.modes if mode.does is flight)


_COMMON = (
    mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
    | mavlink.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
    | mavlink.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION
    | mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
)
MODE_TABLES = {
    "px4": ModeTable(
        "px4",
        mavlink.MAV_AUTOPILOT_PX4,
        PX4_MODES,
        PX4_MODES[7],
        bytewise=True,
        capabilities=_COMMON | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE,
        version=1 << 24 | 16 << 16 | 1 << 8 | 255,
    ),
    "ardupilot": ModeTable(
        "ardupilot",
        mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA,
        ARDUPILOT_MODES,
        ARDUPILOT_MODES[0],
        bytewise=False,
        capabilities=_COMMON | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT,
        version=4 << 24 | 6 << 16 | 0 << 8 | 255,
    ),
}


def dialect(name: str) -> ModeTable:
    """Return a dialect by name.

    Raises:
        UsageError: there is none of that name.
    """
    if name not in MODE_TABLES:
        raise UsageError(f"unknown dialect {name!r}: {nearest(name, MODE_TABLES)}")
    return MODE_TABLES[name]
