"""The simulated autopilot's own precision landing: over the pad, and down while it is over it.

As the landing controllers of PX4 (`src/modules/navigator/precland.cpp`) and ArduPilot
(`AC_PrecLand`) do with LANDING_TARGET: the pad's newest place counts for a while, and where none
comes any more the vehicle lands where it is.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from missionkit.geometry import Vec3, vec
from missionkit.messages import Setpoint

FORGOTTEN = 2.0  # s, after which a place does not count any more; PX4: PLD_BTOUT is longer
LEVEL_GAIN, FASTEST = 0.8, 1.5  # 1/s and m/s
DESCENT_GAIN, SLOWEST_DESCENT, FASTEST_DESCENT = 0.5, 0.25, 0.7  # 1/s and m/s
OVER, OVER_SHARE = 0.15, 0.1  # m, and of the height: level, from the pad, at which it descends
TOUCH_DOWN = 0.25  # m above the pad, from where it lands


class PadTarget(NamedTuple):
    """Where the pad is."""

    at: float  # s, when it was heard
    place: Vec3  # (3,), m, NED


def velocity_to_pad(pad: PadTarget | None, position: Vec3, now: float) -> Setpoint | None:
    """Return the velocity that leads down on the pad, None where it lands as it is.

    Args:
        pad: as heard last.
        position: (3,), m, NED, of the vehicle.
        now: s.
    """
    if pad is None or now - pad.at > FORGOTTEN:
        return None
    north, east, height = (pad.place - position).tolist()
    if height <= TOUCH_DOWN:
        return None
    level = math.hypot(north, east)
    gain = min(LEVEL_GAIN, FASTEST / max(level, 1e-6))
    sinking = min(FASTEST_DESCENT, max(SLOWEST_DESCENT, DESCENT_GAIN * height))
    down = sinking if level <= OVER + OVER_SHARE * height else 0.0
    return Setpoint(vec(gain * north, gain * east, down), 0.0)
