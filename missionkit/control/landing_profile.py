"""Closing a level distance and coming down, as fast as both can end together.

Level, from afar at `top`, then braking; near, the speed falls with the distance (`approach_speed`):

    v(x) = k x  where k² x <= b,   else  sqrt(2 b (x - b/(2 k²)))

Down, at a rate d, and at last slower at c to the speed of touch-down. How high the vehicle should
be follows from the time that the level distance still takes: it comes down as late as it can, never
waits on its way, and does not come down while it is off the pad.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from missionkit.control.velocity_limits import approach_speed


class Closing(NamedTuple):
    """How a level distance is closed."""

    gain: float  # 1/s, k
    braking: float  # m/s², b
    top: float  # m/s


class Descent(NamedTuple):
    """How a height is come down from."""

    rate: float  # m/s, d
    slowing: float  # m/s², c
    touch_down: float  # m/s


class DescentState(NamedTuple):
    """Where a descent should be."""

    height: float  # m
    rate: float  # m/s
    slowing: float  # m/s²


def closing_speed(closing: Closing, distance: float) -> tuple[float, float]:
    """Return the speed (m/s) at a level distance (m), and how it falls with it (1/s).

    Args:
        closing: gain, braking and top speed.
        distance: m, not negative.
    """
    speed = approach_speed(distance, closing.gain, closing.braking)
    if speed >= closing.top:
        return closing.top, 0.0
    return speed, min(closing.gain, closing.braking / max(speed, 1e-9))


def closing_time(closing: Closing, distance: float, speed: float, within: float) -> float:
    """Return the time (s) until the vehicle is `within` (m) of its goal.

    One that is too fast for its distance counts as far off as that speed belongs to.

    Args:
        closing: gain, braking and top speed.
        distance: m, not negative.
        speed: m/s, level.
        within: m, more than 0.
    """
    k, b = closing.gain, closing.braking
    slow = b / k  # m/s, below it the speed falls with the distance
    near = slow / k
    off = speed / k if speed <= slow else 0.5 * speed * speed / b + 0.5 * near
    distance = max(distance, off)
    if distance <= within:
        return 0.0
    if distance <= near:
        return math.log(distance / within) / k
    reached, _ = closing_speed(closing, distance)
    cruise = distance - 0.5 * reached * reached / b - 0.5 * near
    braking = max(0.0, reached - slow) / b
    return math.log(max(1.0, near / within)) / k + braking + max(0.0, cruise) / reached


def height_before(descent: Descent, time: float, rate: float) -> DescentState:
    """Return how high the vehicle should be `time` (s) before it touches down.

    The lower the slower it sinks so far: what it has to gather speed takes time.

    Args:
        descent: rate, slowing and touch-down.
        time: s.
        rate: m/s, of the vehicle now.
    """
    touch, c = descent.touch_down, descent.slowing
    wanted = min(descent.rate, touch + c * max(0.0, time))
    time -= max(0.0, wanted - rate) ** 2 / (2.0 * c * wanted)
    if time <= 0.0:
        return DescentState(0.0, wanted, 0.0)
    fall, low = _last_part(descent)
    if time <= fall:
        return DescentState(touch * time + 0.5 * c * time * time, touch + c * time, c)
    return DescentState(low + descent.rate * (time - fall), descent.rate, 0.0)


def descent_time(descent: Descent, height: float) -> float:
    """Return the time (s) that coming down takes at best, from the full rate on.

    Args:
        descent: rate, slowing and touch-down.
        height: m, not negative.
    """
    touch, c = descent.touch_down, descent.slowing
    fall, low = _last_part(descent)
    if height > low:
        return fall + (height - low) / descent.rate
    return (math.sqrt(touch * touch + 2.0 * c * height) - touch) / c


def _last_part(descent: Descent) -> tuple[float, float]:
    """Return how long (s) a descent slows down, and over what height (m)."""
    time = max(0.0, descent.rate - descent.touch_down) / descent.slowing
    return time, (descent.touch_down + 0.5 * descent.slowing * time) * time
