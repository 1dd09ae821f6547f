"""A reference place or attitude that moves to a goal with limited speed and acceleration."""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Vec3, norm


def stepped(offset: Vec3, velocity: Vec3, top: float, limit: float, dt: float) -> Vec3:
    """Return the reference's next velocity (3,): towards the goal, and to rest at it.

        |v_desired| = min(top, ½ a dt (sqrt(1 + 8 d / (a dt²)) - 1), d / dt),   |v' - v| <= a dt

    The middle term is sqrt(2 a d) less what a step of dt overshoots it by.

    Args:
        offset: (3,) from the reference to the goal (m, or rad).
        velocity: (3,) of the reference (m/s, or rad/s).
        top: greatest speed.
        limit: a, greatest acceleration (m/s², or rad/s²).
        dt: step (s), above 0.
    """
    away = norm(offset)
    step = limit * dt
    braking = 0.5 * step * (math.sqrt(1.0 + 8.0 * away / (step * dt)) - 1.0)
    speed = min(top, braking, away / dt)
    desired = offset * (speed / away) if away > 0.0 else np.zeros(3)
    change = desired - velocity
    size = norm(change)
    return desired if size <= step else velocity + change * (step / size)
