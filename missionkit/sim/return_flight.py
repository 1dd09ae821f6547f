"""The simulated autopilot's own way home: climb, fly over the place of arming, land.

As PX4's return mode without a cone: it first rises to `return_height`, if it is lower and not over
home already. Its velocities go through the same loop as those of a mission.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from missionkit.geometry import Vec3, vec
from missionkit.messages import Setpoint

OVER_HOME = 1.0  # m, level, from where it lands
NEAR_HOME = 5.0  # m, level, within which it does not climb first
SPEED, CLIMB = 5.0, 1.5  # m/s
LEVEL_GAIN, HEIGHT_GAIN = 0.6, 1.0  # 1/s
RISEN = 0.5  # m, below its height, that counts as having risen


class ReturnFlight(NamedTuple):
    """Where it leads, and how high."""

    north: float  # m
    east: float  # m
    height: float  # m, above the take-off point

    @classmethod
    def begun(cls, home: tuple[float, float], state: Vec3, height: float) -> ReturnFlight:
        """Return the way home from where the vehicle is.

        Args:
            home: m, north and east, the place of arming.
            state: (17,), as in `kernel_layout`.
            height: m, to which it rises at least.
        """
        up = -float(state[2])
        near = math.hypot(home[0] - state[0], home[1] - state[1]) <= NEAR_HOME
        return cls(*home, up if near else max(up, height))


def velocity_home(way: ReturnFlight, state: Vec3) -> Setpoint | None:
    """Return the velocity that leads home, None once the vehicle is over it and has to land.

    Args:
        way: where it leads.
        state: (17,), as in `kernel_layout`.
    """
    north, east = way.north - float(state[0]), way.east - float(state[1])
    left, missing = math.hypot(north, east), way.height + float(state[2])
    if left <= OVER_HOME:
        return None
    up = max(-CLIMB, min(CLIMB, HEIGHT_GAIN * missing))
    if missing > RISEN:
        return Setpoint(vec(0.0, 0.0, -up), 0.0)
    speed = min(SPEED, LEVEL_GAIN * left)
    return Setpoint(vec(speed * north / left, speed * east / left, -up), 0.0)
