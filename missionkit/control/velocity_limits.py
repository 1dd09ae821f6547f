"""Limits of the velocity command: speed, climb, acceleration, and being a number at all.

Vectors are plain tuples here: at three elements scalar arithmetic is several times faster than
numpy, and a control step has a budget of microseconds.
"""

from __future__ import annotations

import math
from typing import TypeAlias

from pydantic import BaseModel, ConfigDict, Field

from missionkit.messages import Setpoint
from missionkit.units import MetresPerSecond, MetresPerSecond2, Seconds

Triple: TypeAlias = tuple[float, float, float]
"""North, east, down."""

ZERO: Triple = (0.0, 0.0, 0.0)


def stopping_speed(gap: float, braking: float, lag: float) -> float:
    """Return the speed (m/s) that stops within `gap` > 0 (m): v t + v²/(2a) = d.

    v = a (sqrt(t² + 2d/a) - t), with the deceleration a `braking` (m/s²) after the lag t (s).

    Args:
        gap: m, more than 0.
        braking: m/s², more than 0.
        lag: s until braking begins.
    """
    return braking * (math.sqrt(lag * lag + 2.0 * gap / braking) - lag)


class Limits(BaseModel):
    """Limits of the velocity command, whatever a behaviour asks for.

    `braking` is the deceleration the approach to a goal is planned with; it stays well under
    `acceleration` so that the lag of the velocity loop does not become overshoot. `lag` is how late
    the vehicle answers, where it must not overshoot at all.
    """

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)

    speed: MetresPerSecond = Field(default=8.0, gt=0)
    climb: MetresPerSecond = Field(default=2.5, gt=0)
    descent: MetresPerSecond = Field(default=1.5, gt=0)
    acceleration: MetresPerSecond2 = Field(default=3.0, gt=0)
    vertical_acceleration: MetresPerSecond2 = Field(default=2.0, gt=0)
    braking: MetresPerSecond2 = Field(default=1.5, gt=0)
    vertical_braking: MetresPerSecond2 = Field(default=1.0, gt=0)
    lag: Seconds = Field(default=0.6, ge=0)

    def bounded(self, velocity: Triple) -> Triple:
        """Return `velocity` (m/s, NED) within horizontal, climb and descent speed.

        The horizontal part keeps its direction; the vertical part is limited by itself.
        """
        x, y, z = velocity
        size = math.hypot(x, y)
        k = self.speed / size if size > self.speed else 1.0
        return x * k, y * k, min(self.descent, max(-self.climb, z))

    def slewed(self, last: Triple, wanted: Triple, dt: float) -> Triple:
        """Return the velocity (m/s, NED) nearest to `wanted` that `dt` seconds after `last` allow.

        The answer lies between the two, so limits that hold for both hold for it.

        Args:
            last: (3,), m/s, NED, of the previous tick.
            wanted: (3,), m/s, NED.
            dt: s since the previous tick.
        """
        x, y, z = wanted[0] - last[0], wanted[1] - last[1], wanted[2] - last[2]
        size = math.hypot(x, y)
        reach = self.acceleration * dt
        k = reach / size if size > reach else 1.0
        rise = self.vertical_acceleration * dt
        return last[0] + k * x, last[1] + k * y, last[2] + min(rise, max(-rise, z))


def within(velocity: Triple, top: float) -> tuple[Triple, bool]:
    """Shorten `velocity` to the length `top` (m/s); say whether that was necessary."""
    x, y, z = velocity
    size = math.sqrt(x * x + y * y + z * z)
    if size <= top:
        return velocity, False
    k = top / size
    return (x * k, y * k, z * k), True


def approach_speed(distance: float, gain: float, braking: float) -> float:
    """Return the speed (m/s) at which to close a `distance` (m).

    Proportional near the goal, v = k d; beyond d = a/k² the speed from which `braking` a (m/s²)
    stops in time, v = sqrt(2 a (d - a/(2k²))). The two join with equal value and slope.

    Source: ArduPilot, `sqrt_controller` in AP_Math/control.cpp.

    Args:
        distance: m.
        gain: k, 1/s.
        braking: a, m/s².
    """
    if gain * gain * distance <= braking:
        return gain * distance
    return math.sqrt(2.0 * braking * (distance - 0.5 * braking / (gain * gain)))


def finite(setpoint: Setpoint) -> Setpoint | None:
    """Return the setpoint if every number in it is finite, else None: the vehicle is to hold."""
    x, y, z = setpoint.velocity.tolist()
    numbers = (x, y, z, setpoint.yaw_rate)
    return setpoint if all(map(math.isfinite, numbers)) else None
