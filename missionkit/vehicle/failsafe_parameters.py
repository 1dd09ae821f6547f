"""Parameters that decide what the autopilot does when something is lost, and what is safe.

Sources: PX4 parameter reference (Commander, Battery, Circuit Breaker); ArduCopter parameter list.
"""

from __future__ import annotations

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


PX4_FAILSAFES = (
    FailsafeParameter(
        "COM_OF_LOSS_T",
        0.2,
        1.0,
        FailsafeLevel.WARNING,
        "it flies on for long when setpoints stop, or ends offboard at the least hiccup",
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
        "nothing happens when the battery is all but empty",
        "set 1 (land)",
        safe=1,
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
