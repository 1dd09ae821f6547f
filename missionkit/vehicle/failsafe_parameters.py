"""Parameters that decide what the autopilot does when something is lost, and what is safe.

Sources: PX4 parameter reference (Commander, Battery, Circuit Breaker); ArduCopter parameter list.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import IntEnum
from typing import NamedTuple

UNATTENDED = (
    "a low battery is only reported: a vehicle left holding by a mission that died stays up until "
    "its battery is empty"
)


class FailsafeLevel(IntEnum):
    """How bad something is before a flight."""

    GOOD = 0
    WARNING = 1
    BAD = 2


class FailsafeParameter(NamedTuple):
    """A parameter, the values that are safe, and why others are not."""

    parameter: str
    least: float
    most: float
    level: FailsafeLevel  # of other values
    otherwise: str  # what happens with another value
    remedy: str
    fatal: tuple[float, ...] = ()  # values that stop the rotors in the air
    safe: float | None = None  # what `preflight --set` writes; None: that is for a person to choose

    def judge(self, value: float) -> tuple[FailsafeLevel, str]:
        """Return how good a value is, and what to say about it."""
        if self.least <= value <= self.most:
            return FailsafeLevel.GOOD, ""
        if value in self.fatal:
            return FailsafeLevel.BAD, f"it stops the rotors in the air; {self.remedy}"
        return self.level, f"{self.otherwise}; {self.remedy}"


class VoltageMonitor(NamedTuple):
    """A battery monitor that does not measure the current."""

    parameter: str
    value: float  # of it
    charge: str  # threshold that has no effect then
    remedy: str


class FailsafeThresholds(NamedTuple):
    """Thresholds of one failsafe, of which one at least must be above zero for it to act."""

    parameters: tuple[str, ...]
    otherwise: str  # what happens if all are zero
    remedy: str
    voltage_only: VoltageMonitor | None = None

    def judge(self, values: Mapping[str, float | None]) -> tuple[FailsafeLevel, str]:
        """Return how good the values are, and what to say about them."""
        known = {name: value for name in self.parameters if (value := values.get(name)) is not None}
        able = {name: it for name, it in known.items() if it > 0.0}
        monitor = self.voltage_only
        if monitor is not None and values.get(monitor.parameter) == monitor.value:
            blind = able.pop(monitor.charge, None)
        else:
            blind = None
        if able:
            return FailsafeLevel.GOOD, ", ".join(f"{name} {it:g}" for name, it in known.items())
        if len(known) < len(self.parameters):
            return FailsafeLevel.WARNING, "could not be read: look at it by hand"
        if monitor is not None and blind is not None:
            return FailsafeLevel.WARNING, (
                f"{monitor.charge} {blind:g} cannot act, because {monitor.parameter} "
                f"{monitor.value:g} measures no current: {self.otherwise}; {monitor.remedy}"
            )
        every = "is 0" if len(known) == 1 else "are both 0"
        says = f"{' and '.join(known)} {every}: {self.otherwise}; {self.remedy}"
        return FailsafeLevel.WARNING, says


PX4_FAILSAFES = (
    FailsafeParameter(
        "COM_OF_LOSS_T",
        0.2,
        1.0,
        FailsafeLevel.WARNING,
        "it flies on too long when setpoints stop, or leaves offboard at the slightest hiccup",
        "set 0.5 to 1 s",
        safe=1.0,
    ),
    FailsafeParameter(
        "COM_OBL_RC_ACT",
        3,
        5,
        FailsafeLevel.WARNING,
        "when setpoints stop it waits for a pilot at the remote control; without one it returns",
        "set 5 (hold), 4 (land) or 3 (return)",
        (6, 7),
        safe=5,
    ),
    FailsafeParameter(
        "NAV_DLL_ACT",
        1,
        3,
        FailsafeLevel.WARNING,
        "nothing happens when the data link is lost",
        "set 1 (hold), 2 (return) or 3 (land)",
        (5, 6),
    ),
    FailsafeParameter(
        "COM_DL_LOSS_T",
        1,
        15,
        FailsafeLevel.WARNING,
        "a lost data link is noticed late",
        "set 5 to 10 s",
        safe=10,
    ),
    FailsafeParameter(
        "COM_LOW_BAT_ACT",
        2,
        3,
        FailsafeLevel.WARNING,
        UNATTENDED,
        "set 3 (return, then land)",
        safe=3,
    ),
    FailsafeParameter(
        "BAT1_SOURCE",
        0,
        math.inf,
        FailsafeLevel.WARNING,
        f"the battery is not measured, COM_LOW_BAT_ACT has no effect: {UNATTENDED}",
        "set 0 (power module), or the source that the vehicle has",
    ),
)
PX4_THRESHOLDS = (
    FailsafeThresholds(
        ("BAT_CRIT_THR",),
        "a battery never counts as critical, COM_LOW_BAT_ACT waits for an emergency",
        "set 0.07 or more",
    ),
    FailsafeThresholds(
        ("BAT_EMERGEN_THR",),
        "a battery is never an emergency, so nothing lands a vehicle that cannot return",
        "set 0.05 or more, below BAT_CRIT_THR",
    ),
)

ARDUPILOT_FAILSAFES = (
    FailsafeParameter(
        "GUID_TIMEOUT",
        0.1,
        1.0,
        FailsafeLevel.WARNING,
        "it flies on for that long (s) when setpoints stop",
        "set 1 s or less",
        safe=1.0,
    ),
    FailsafeParameter(
        "FS_GCS_ENABLE",
        1,
        7,
        FailsafeLevel.WARNING,
        "nothing happens when the data link is lost",
        "set 5 (land) or 1 (return)",
    ),
    FailsafeParameter(
        "FS_THR_ENABLE",
        1,
        7,
        FailsafeLevel.WARNING,
        "nothing happens when the remote control is lost",
        "set 1 (return) or 3 (land)",
    ),
    FailsafeParameter(
        "FS_EKF_ACTION",
        1,
        3,
        FailsafeLevel.BAD,
        "nothing happens when the position estimate fails",
        "set 1 (land)",
        safe=1,
    ),
    FailsafeParameter(
        "BATT_FS_LOW_ACT",
        1,
        7,
        FailsafeLevel.WARNING,
        UNATTENDED,
        "set 2 (return) or 1 (land)",
        safe=2,
    ),
    FailsafeParameter(
        "BATT_FS_CRT_ACT",
        1,
        4,
        FailsafeLevel.WARNING,
        "nothing happens when the battery is almost empty",
        "set 1 (land)",
        safe=1,
    ),
    FailsafeParameter(
        "BATT_MONITOR",
        1,
        math.inf,
        FailsafeLevel.WARNING,
        "the battery is not measured, BATT_FS_LOW_ACT and BATT_FS_CRT_ACT have no effect: "
        f"{UNATTENDED}",
        "set the kind of the battery monitor, such as 4 (voltage and current)",
    ),
    FailsafeParameter(
        "FENCE_ENABLE",
        1,
        1,
        FailsafeLevel.WARNING,
        "no fence holds the vehicle should everything else fail",
        "set 1, with FENCE_RADIUS and FENCE_ALT_MAX",
    ),
)
_ANALOG_VOLTAGE_ONLY = 3  # BATT_MONITOR


def _without_current(level: str) -> VoltageMonitor:
    remedy = f"set BATT_{level}_VOLT (V), or BATT_MONITOR 4 if the current is measured"
    return VoltageMonitor("BATT_MONITOR", _ANALOG_VOLTAGE_ONLY, f"BATT_{level}_MAH", remedy)


ARDUPILOT_THRESHOLDS = (
    FailsafeThresholds(
        ("BATT_LOW_VOLT", "BATT_LOW_MAH"),
        "no battery counts as low, BATT_FS_LOW_ACT has no effect",
        "set BATT_LOW_VOLT (V) to suit the cells, or BATT_LOW_MAH",
        _without_current("LOW"),
    ),
    FailsafeThresholds(
        ("BATT_CRT_VOLT", "BATT_CRT_MAH"),
        "no battery counts as critical, BATT_FS_CRT_ACT has no effect",
        "set BATT_CRT_VOLT (V) below BATT_LOW_VOLT, or BATT_CRT_MAH",
        _without_current("CRT"),
    ),
)
