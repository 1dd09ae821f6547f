"""Profiles of a landing: level to rest over the pad, down to the rate of touch-down; compiled.

Each is a trapezoid of speed over time, with its four marks: when it has gathered speed, begins to
slow and ends, and the speed in between. Source: P3 section VI-B.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled


class LandingLimits(NamedTuple):
    """Limits of speed and acceleration (SI)."""

    speed: float = 6.0  # m/s, level
    acceleration: float = 2.5  # m/s², level
    braking: float = 2.5  # m/s², level
    descent: float = 1.5  # m/s
    vertical_acceleration: float = 2.0  # m/s²
    touch_down: float = 0.4  # m/s


@compiled
def level_times(distance: float, closing: float, top: float, limits: LandingLimits) -> Vec3:
    """Return when (s) the level profile has gathered speed, begins to brake and ends; its speed.

    The speed (m/s) is `top`, or less where the way is too short for it.

    Args:
        distance: to the pad, level, m.
        closing: speed towards the pad at the start, m/s, not negative.
        top: speed wanted in between, m/s.
        limits: of acceleration and braking.

    Returns:
        (4,): three times (s) and a speed (m/s).
    """
    a, b = limits.acceleration, limits.braking
    reach = math.sqrt((2.0 * a * b * distance + b * closing * closing) / (a + b))
    top = max(min(top, reach), min(closing, reach))
    rise = abs(top - closing) / (a if top >= closing else b)
    steady = distance - 0.5 * (top + closing) * rise - 0.5 * top * top / b
    cruise = max(0.0, steady) / max(top, 1e-6)
    return np.array((rise, rise + cruise, rise + cruise + top / b, top))


@compiled
def level_at(t: float, closing: float, marks: Vec3) -> tuple[float, float]:
    """Return way flown (m) and speed (m/s) of the level profile at `t` (s).

    Args:
        t: s, from the start of the path.
        closing: speed towards the pad at the start, m/s.
        marks: (4,) of `level_times`.
    """
    rise, brake, end, top = marks[0], marks[1], marks[2], marks[3]
    a = (top - closing) / rise if rise > 0.0 else 0.0
    if t <= rise:
        return closing * t + 0.5 * a * t * t, closing + a * t
    way = 0.5 * (closing + top) * rise
    if t <= brake:
        return way + top * (t - rise), top
    u = min(t, end) - brake
    slowing = top / (end - brake) if end > brake else 0.0
    return way + top * (brake - rise) + top * u - 0.5 * slowing * u * u, top - slowing * u


@compiled
def vertical_marks(height: float, rate: float, limits: LandingLimits) -> Vec3:
    """Return when (s) a descent has gathered speed, begins to slow and ends; its rate (m/s).

    Args:
        height: above the pad, m.
        rate: of descent wanted in between, m/s, positive down.
        limits: of vertical acceleration and the rate at touch-down.

    Returns:
        (4,): three times (s) from the start of the descent and a rate (m/s).
    """
    c, touch = limits.vertical_acceleration, limits.touch_down
    reach = math.sqrt(c * height + 0.5 * touch * touch)
    rate = min(rate, reach)
    touch = min(touch, rate)
    rise, fall = rate / c, (rate - touch) / c
    steady = height - 0.5 * rate * rise - 0.5 * (rate + touch) * fall
    hold = max(0.0, steady) / max(rate, 1e-6)
    return np.array((rise, rise + hold, rise + hold + fall, rate))


@compiled
def vertical_at(t: float, marks: Vec3, limits: LandingLimits) -> tuple[float, float]:
    """Return way (m) and rate (m/s) of a descent at `t` (s) after it began.

    Args:
        t: s; before the descent it is negative.
        marks: (4,) of `vertical_marks`.
        limits: of vertical acceleration.

    Returns:
        Positive down.
    """
    rise, fall, end, rate = marks[0], marks[1], marks[2], marks[3]
    c = limits.vertical_acceleration
    if t <= 0.0:
        return 0.0, 0.0
    if t <= rise:
        return 0.5 * c * t * t, c * t
    way = 0.5 * rate * rise
    if t <= fall:
        return way + rate * (t - rise), rate
    u = min(t, end) - fall
    return way + rate * (fall - rise) + rate * u - 0.5 * c * u * u, rate - c * u


@compiled
def descent_begins(
    distance: float, height: float, closing: float, marks: Mat, limits: LandingLimits, gate: Vec3
) -> float:
    """Return the first moment (s) to begin the descent: not too early for pad and gate.

    Args:
        distance: to the pad at the start, level, m.
        height: above the pad at the start, m.
        closing: speed towards the pad at the start, m/s.
        marks: (2, 4), of `level_times` and `vertical_marks`.
        limits: of vertical acceleration.
        gate: (2,), distance and height, m; a height of 0 means none.
    """
    level, down = marks[0], marks[1]
    begin = max(0.0, level[2] - down[2])
    if gate[1] <= 0.0 or gate[1] >= height or distance <= gate[0]:
        return float(begin)
    low, high = 0.0, level[2]  # when it comes within the gate's distance
    for _ in range(40):
        middle = 0.5 * (low + high)
        way, _ = level_at(middle, closing, level)
        if distance - way > gate[0]:
            low = middle
        else:
            high = middle
    entry, low, top = high, 0.0, down[2]  # how long the descent may have lasted by then
    for _ in range(40):
        middle = 0.5 * (low + top)
        way, _ = vertical_at(middle, down, limits)
        if height - way > gate[1]:
            low = middle
        else:
            top = middle
    return float(max(begin, entry - low))
