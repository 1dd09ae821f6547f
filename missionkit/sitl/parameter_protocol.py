"""Parameters: the table of each autopilot, and the parameter protocol.

Sources: https://mavlink.io/en/services/parameter.html;
https://docs.px4.io/main/en/advanced_config/parameter_reference.html;
https://ardupilot.org/copter/docs/parameters.html (4.6).

Defaults are the autopilots' own, but COM_LOW_BAT_ACT is 3 as seen in PX4's simulations, and
MPC_THR_HOVER and BATT_CAPACITY are those of the vehicle.
"""

from __future__ import annotations

import struct
from typing import NamedTuple

from missionkit.errors import UsageError, nearest
from missionkit.sitl.pymavlink_dialect import Message, mavlink

INT8, INT16 = mavlink.MAV_PARAM_TYPE_INT8, mavlink.MAV_PARAM_TYPE_INT16
INT32, REAL32 = mavlink.MAV_PARAM_TYPE_INT32, mavlink.MAV_PARAM_TYPE_REAL32

PX4_PARAMETERS: dict[str, float] = {  # an int is an INT32
    "BAT1_SOURCE": 0,
    "BAT_CRIT_THR": 0.07,
    "BAT_EMERGEN_THR": 0.05,
    "BAT_LOW_THR": 0.15,
    "COM_ARM_BAT_MIN": -1.0,
    "COM_DISARM_LAND": 2.0,
    "COM_DISARM_PRFLT": 10.0,
    "COM_DL_LOSS_T": 10,
    "COM_FAIL_ACT_T": 5.0,
    "COM_LOW_BAT_ACT": 3,
    "COM_OBL_RC_ACT": 0,
    "COM_OF_LOSS_T": 1.0,
    "COM_RCL_EXCEPT": 0,
    "COM_RC_IN_MODE": 0,
    "COM_RC_LOSS_T": 0.5,
    "COM_RC_OVERRIDE": 1,
    "EKF2_NOAID_TOUT": 5_000_000,
    "EKF2_OF_CTRL": 0,
    "GF_ACTION": 2,
    "GF_MAX_HOR_DIST": 0.0,
    "GF_MAX_VER_DIST": 0.0,
    "MAV_COMP_ID": 1,
    "MAV_SYS_ID": 1,
    "MAV_TYPE": 2,
    "MIS_TAKEOFF_ALT": 2.5,
    "MPC_LAND_SPEED": 0.7,
    "MPC_THR_HOVER": 0.45,
    "MPC_TKO_SPEED": 1.5,
    "MPC_XY_CRUISE": 5.0,
    "MPC_XY_P": 0.95,
    "MPC_XY_VEL_MAX": 12.0,
    "MPC_Z_P": 1.0,
    "MPC_Z_VEL_MAX_DN": 1.5,
    "MPC_Z_VEL_MAX_UP": 3.0,
    "NAV_ACC_RAD": 2.0,
    "NAV_DLL_ACT": 0,
    "NAV_RCL_ACT": 2,
    "RTL_CONE_ANG": 45,
    "RTL_DESCEND_ALT": 30.0,
    "RTL_MIN_DIST": 10.0,
    "RTL_RETURN_ALT": 60.0,
    "SYS_AUTOSTART": 4001,
    "SYS_FAILURE_EN": 0,
}
ARDUPILOT_PARAMETERS: dict[str, float] = {  # an int is an INT16
    "ARMING_CHECK": 1,
    "BATT_CAPACITY": 1500,
    "BATT_CRT_MAH": 0.0,
    "BATT_CRT_VOLT": 0.0,
    "BATT_FS_CRT_ACT": 0,
    "BATT_FS_LOW_ACT": 0,
    "BATT_LOW_MAH": 0.0,
    "BATT_LOW_TIMER": 10,
    "BATT_LOW_VOLT": 10.5,
    "BATT_MONITOR": 4,
    "DISARM_DELAY": 10,
    "EK3_SRC1_VELXY": 3,
    "FENCE_ACTION": 1,
    "FENCE_ALT_MAX": 100.0,
    "FENCE_ENABLE": 0,
    "FENCE_RADIUS": 300.0,
    "FENCE_TYPE": 7,
    "FRAME_CLASS": 1,
    "FRAME_TYPE": 1,
    "FS_CRASH_CHECK": 1,
    "FS_EKF_ACTION": 1,
    "FS_EKF_THRESH": 0.8,
    "FS_GCS_ENABLE": 0,
    "FS_GCS_TIMEOUT": 5.0,
    "FS_OPTIONS": 16,
    "FS_THR_ENABLE": 1,
    "GUID_OPTIONS": 0,
    "GUID_TIMEOUT": 3.0,
    "LAND_SPEED": 50,
    "PILOT_SPEED_UP": 250,
    "PSC_POSXY_P": 1.0,
    "PSC_POSZ_P": 1.0,
    "RC_FS_TIMEOUT": 1.0,
    "PLND_ENABLED": 0,
    "PLND_TYPE": 1,
    "RTL_ALT": 1500,
    "RTL_ALT_FINAL": 0,
    "RTL_CLIMB_MIN": 0,
    "RTL_CONE_SLOPE": 3.0,
    "RTL_LOIT_TIME": 5000,
    "SYSID_MYGCS": 255,
    "SYSID_THISMAV": 1,
    "WPNAV_RADIUS": 200.0,
    "WPNAV_SPEED": 1000.0,
    "WPNAV_SPEED_DN": 150.0,
    "WPNAV_SPEED_UP": 250.0,
}
TABLES = {"px4": PX4_PARAMETERS, "ardupilot": ARDUPILOT_PARAMETERS}


class ParameterEntry(NamedTuple):
    """One parameter as it is now."""

    name: str
    value: float
    kind: int  # MAV_PARAM_TYPE


class Parameters:
    """All parameters of one autopilot."""

    def __init__(self, dialect: str, *, bytewise: bool) -> None:
        whole = INT32 if bytewise else INT16
        self._bytewise = bytewise
        self._entries = {
            name: ParameterEntry(name, value, whole if isinstance(value, int) else REAL32)
            for name, value in TABLES[dialect].items()
        }
        self._names = sorted(self._entries)

    def __getitem__(self, name: str) -> float:
        return self._entries[name].value

    def __len__(self) -> int:
        return len(self._names)

    def set(self, name: str, value: float) -> None:
        """Give a parameter a value, rounded if it is an integer.

        Raises:
            UsageError: there is none of that name.
        """
        if name not in self._entries:
            raise UsageError(f"unknown parameter {name!r}: {nearest(name, self._names)}")
        entry = self._entries[name]
        kept = value if entry.kind == REAL32 else round(value)
        self._entries[name] = entry._replace(value=kept)

    def find(self, name: str, index: int) -> str | None:
        """Return the name of the parameter that PARAM_REQUEST_READ asks for."""
        if index >= 0:
            return self._names[index] if index < len(self._names) else None
        return name if name in self._entries else None

    def param_value_message(self, name: str) -> Message:
        """Return the PARAM_VALUE of a parameter."""
        entry = self._entries[name]
        value = self._encoded(entry)
        index = self._names.index(name)
        return mavlink.MAVLink_param_value_message(
            name.encode(), value, entry.kind, len(self._names), index
        )

    def accept(self, name: str, value: float) -> bool:
        """Take over the value of a PARAM_SET; return whether there is such a parameter."""
        entry = self._entries.get(name)
        if entry is None:
            return False
        self.set(name, self._decoded(entry, value))
        return True

    def _encoded(self, entry: ParameterEntry) -> float:
        if entry.kind == REAL32 or not self._bytewise:
            return float(entry.value)
        return float(struct.unpack("<f", struct.pack("<i", int(entry.value)))[0])

    def _decoded(self, entry: ParameterEntry, value: float) -> float:
        if entry.kind == REAL32 or not self._bytewise:
            return value
        return float(struct.unpack("<i", struct.pack("<f", value))[0])

    @property
    def names(self) -> tuple[str, ...]:
        """All names, in the order of their index."""
        return tuple(self._names)
