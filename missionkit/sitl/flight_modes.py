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


class Flight(StrEnum):
    """Behaviour of the vehicle in a mode. A pilot's sticks are centred: it hovers."""

    PILOT = auto()
    COMMANDED = auto()
    TAKE_OFF = auto()
    HOLD = auto()
    MISSION = auto()
    RETURN = auto()
    LAND = auto()


class Mode(NamedTuple):
    """One flight mode of an autopilot."""

    name: str
    number: int  # custom_mode
    does: Flight
    arming: bool = True  # may be armed in
    base: int = STABILIZE_FLAG | MANUAL_FLAG  # MAV_MODE_FLAG, besides CUSTOM_FLAG and ARMED_FLAG
    needs_position: bool = True


def _px4(main: int, sub: int = 0) -> int:
    return sub << 24 | main << 16


_SELF = STABILIZE_FLAG | GUIDED_FLAG | AUTO_FLAG
PX4_MODES = (
    Mode("MANUAL", _px4(1), Flight.PILOT, base=MANUAL_FLAG, needs_position=False),
    Mode("ALTCTL", _px4(2), Flight.PILOT, needs_position=False),
    Mode("POSCTL", _px4(3), Flight.PILOT, base=STABILIZE_FLAG | GUIDED_FLAG | MANUAL_FLAG),
    Mode("ACRO", _px4(5), Flight.PILOT, base=MANUAL_FLAG, needs_position=False),
    Mode("OFFBOARD", _px4(6), Flight.COMMANDED, base=_SELF),
    Mode("STABILIZED", _px4(7), Flight.PILOT, needs_position=False),
    Mode("TAKEOFF", _px4(4, 2), Flight.TAKE_OFF, base=_SELF),
    Mode("LOITER", _px4(4, 3), Flight.HOLD, base=_SELF),
    Mode("MISSION", _px4(4, 4), Flight.MISSION, base=_SELF),
    Mode("RTL", _px4(4, 5), Flight.RETURN, arming=False, base=_SELF),
    Mode("LAND", _px4(4, 6), Flight.LAND, arming=False, base=_SELF, needs_position=False),
    Mode("ORBIT", _px4(3, 1), Flight.HOLD, arming=False, base=_SELF),
)

_ALONE = STABILIZE_FLAG | GUIDED_FLAG | MANUAL_FLAG
ARDUPILOT_MODES = (
    Mode("STABILIZE", 0, Flight.PILOT, needs_position=False),
    Mode("ACRO", 1, Flight.PILOT, needs_position=False),
    Mode("ALT_HOLD", 2, Flight.PILOT, needs_position=False),
    Mode("AUTO", 3, Flight.MISSION, arming=False, base=_ALONE),
    Mode("GUIDED", 4, Flight.COMMANDED, base=_ALONE),
    Mode("LOITER", 5, Flight.PILOT, base=_ALONE),
    Mode("RTL", 6, Flight.RETURN, arming=False, base=_ALONE),
    Mode("LAND", 9, Flight.LAND, arming=False, needs_position=False),
    Mode("POSHOLD", 16, Flight.PILOT, base=_ALONE),
    Mode("BRAKE", 17, Flight.HOLD, arming=False, base=_ALONE),
    Mode("SMART_RTL", 21, Flight.RETURN, arming=False, base=_ALONE),
)


class ModeTable(NamedTuple):
    """Differences between the autopilots on the wire."""

    name: str
    autopilot: int  # MAV_AUTOPILOT
    modes: tuple[Mode, ...]
    initial: Mode
    bytewise: bool  # integer parameters keep their bytes, PX4; else their value
    capabilities: int
    version: int  # flight_sw_version

    def mode(self, number: int) -> Mode | None:
        """Return the mode with that custom_mode."""
        return next((mode for mode in self.modes if mode.number == number), None)

    def named(self, name: str) -> Mode:
        """Return the mode with that name, in any case.

        Raises:
            UsageError: there is none.
        """
        for mode in self.modes:
            if mode.name == name.upper():
                return mode
        hint = nearest(name.upper(), [mode.name for mode in self.modes])
        raise UsageError(f"{self.name} has no mode {name!r}: {hint}")

    def doing(self, flight: Flight) -> Mode:
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
