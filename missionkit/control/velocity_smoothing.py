"""Exponential moving average of the velocity command.  Source: P1 section 6.2."""

from __future__ import annotations

import math

from missionkit.control.velocity_limits import Triple

CONTROL_RATE = 20.0  # Hz, the control rate for which P1 states alpha


def alpha_at(alpha: float, dt: float) -> float:
    """Return the weight that keeps the time constant of `alpha` when a step lasts `dt` (s).

    n steps of weight a equal one of 1 - (1 - a)^n, here with n = dt * 20 Hz. `alpha` in [0, 1].
    """
    return 1.0 - math.pow(1.0 - alpha, dt * CONTROL_RATE)


def smoothed(last: Triple, wanted: Triple, alpha: float) -> Triple:
    """Return alpha * wanted + (1 - alpha) * last, per axis (m/s).

    Args:
        last: (3,), m/s, NED, of the previous tick.
        wanted: (3,), m/s, NED.
        alpha: share of the new value, 0 to 1.
    """
    rest = 1.0 - alpha
    return (
        alpha * wanted[0] + rest * last[0],
        alpha * wanted[1] + rest * last[1],
        alpha * wanted[2] + rest * last[2],
    )
