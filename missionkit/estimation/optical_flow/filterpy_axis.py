"""The Kalman filter of one axis by filterpy: the choice `axis_filter: filterpy` of `flow_kalman`.

The equations, arguments and answers of `axis_filter`, whose kernels are the default. filterpy
propagates a NaN silently: what goes in is checked before, and what comes out counts only if all of
it is finite.
"""

from __future__ import annotations

import math

import numpy as np
from filterpy import kalman

from missionkit.estimation.optical_flow.axis_filter import LARGEST_INPUT
from missionkit.geometry import Mat, Vec3


def predict(mu: Vec3, S: Mat, u: float, dt: float, variance: float) -> bool:
    """μ := A μ + B u,  Σ := A Σ Aᵀ + B σ² Bᵀ  (P2, (2) and (3)), in place.

    Says whether it was done: an input that is not finite, or a step backwards, changes nothing.

    Args:
        mu: (2,), m and m/s.
        S: (2, 2) covariance.
        u: acceleration (m/s²).
        dt: step (s).
        variance: σ², of the acceleration over such a step (m²/s⁴).
    """
    if not (abs(u) < LARGEST_INPUT and 0.0 <= dt < LARGEST_INPUT):
        return False
    A, B = np.array([[1.0, dt], [0.0, 1.0]]), np.array([0.5 * dt * dt, dt])
    return _taken(mu, S, *kalman.predict(mu, S, A, variance * np.outer(B, B), u, B))


def update(mu: Vec3, S: Mat, z: float, noise: float, part: int) -> bool:
    """Correct by a measurement z of x (`part` 0) or v (`part` 1), in place  (P2, (4) to (6)).

    Says whether it was done: a measurement that is not finite, or has a variance `noise` that is
    no variance, changes nothing.

    Args:
        mu: (2,), m and m/s.
        S: (2, 2) covariance.
        z: measurement (m, or m/s).
        noise: R, its variance (m², or m²/s²).
        part: POSITION or VELOCITY.
    """
    s = S[part, part] + noise
    if not (abs(z) < LARGEST_INPUT and 0.0 <= noise < math.inf and s > 0.0):
        return False
    H = np.eye(2)[part : part + 1]
    return _taken(mu, S, *kalman.update(mu, S, np.array([z]), np.array([[noise]]), H))


def _taken(mu: Vec3, S: Mat, x: Vec3, P: Mat) -> bool:
    """Put a result in place if all of it is finite."""
    if not (np.isfinite(x).all() and np.isfinite(P).all()):
        return False
    mu[:] = x
    S[:] = 0.5 * (P + P.T)
    return True
