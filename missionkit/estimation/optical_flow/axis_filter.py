"""The Kalman filter of one axis: position and velocity, driven by an acceleration; compiled.

    μ = (x, v),   A = [[1, dt], [0, 1]],   B = (½ dt², dt)

Source: P2 section III-B; its `z_t` is a scalar and its σ and R are variances (correction P2.3).
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled

AXIS_POSITION, AXIS_VELOCITY = 0, 1
LARGEST_INPUT = 1e6
"""No input is larger than this, in SI units."""


@compiled
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
    mu[0] += dt * mu[1] + 0.5 * dt * dt * u
    mu[1] += dt * u
    a, b, d = S[0, 0], 0.5 * (S[0, 1] + S[1, 0]), S[1, 1]
    half = 0.5 * dt * dt
    S[0, 0] = a + 2.0 * dt * b + dt * dt * d + half * half * variance
    S[0, 1] = S[1, 0] = b + dt * d + half * dt * variance
    S[1, 1] = d + dt * dt * variance
    return True


@compiled
def update(mu: Vec3, S: Mat, z: float, noise: float, part: int) -> bool:
    """Correct by a measurement z of x (`part` 0) or v (`part` 1: H = [0 1]), in place.

        K = Σ Hᵀ (H Σ Hᵀ + R)⁻¹,   μ := μ + K (z - H μ),   Σ := (I - K H) Σ   (P2, (4) to (6))

    Σ is taken in Joseph's form, (I - K H) Σ (I - K H)ᵀ + K R Kᵀ: the same, and it stays positive.
    Says whether it was done: a measurement that is not finite, or has a variance `noise` that is
    no variance, changes nothing.

    Args:
        mu: (2,) position and velocity of the axis, changed in place.
        S: (2, 2) covariance, changed in place.
        z: m or m/s.
        noise: R, variance of z.
        part: 0 for a position, 1 for a velocity.
    """
    s = S[part, part] + noise
    if not (abs(z) < LARGEST_INPUT and 0.0 <= noise < math.inf and s > 0.0):
        return False
    r = z - mu[part]
    k0, k1 = S[0, part] / s, S[1, part] / s
    mu[0] += k0 * r
    mu[1] += k1 * r
    a, b, d = S[0, 0], S[0, 1], S[1, 1]
    if part == AXIS_VELOCITY:
        keep = 1.0 - k1
        S[0, 0] = max(a - 2.0 * k0 * b + k0 * k0 * s, 0.0)
        S[0, 1] = S[1, 0] = keep * (b - k0 * d) + k0 * k1 * noise
        S[1, 1] = keep * keep * d + k1 * k1 * noise
    else:
        keep = 1.0 - k0
        S[0, 0] = keep * keep * a + k0 * k0 * noise
        S[0, 1] = S[1, 0] = keep * (b - k1 * a) + k0 * k1 * noise
        S[1, 1] = max(d - 2.0 * k1 * b + k1 * k1 * s, 0.0)
    return True


@compiled
def run(mu: Vec3, S: Mat, us: Vec3, zs: Vec3, dt: float, variance: float, noise: float) -> Mat:
    """Filter a whole flight in place; return μ (n, 2) after each of n steps.

    A velocity in `zs` (n,) that is not finite was not measured; `us` (n,) are accelerations.

    Args:
        mu: (2,) position (m) and velocity (m/s), changed in place.
        S: (2, 2) covariance, changed in place.
        us: (n,) accelerations, m/s².
        zs: (n,) velocities, m/s.
        dt: s of a step.
        variance: σ² of the acceleration, m²/s⁴.
        noise: R of a velocity, m²/s².
    """
    out = np.empty((len(us), 2))
    for i in range(len(us)):
        predict(mu, S, us[i], dt, variance)
        update(mu, S, zs[i], noise, AXIS_VELOCITY)
        out[i, 0], out[i, 1] = mu[0], mu[1]
    return out


def settled(variance: float, noise: float, dt: float) -> float:
    """Return the velocity's variance before an update once the filter has settled.

    p = ½ (q + sqrt(q² + 4 q R)),  q = dt² σ²: the scalar Riccati equation p = p R / (p + R) + q.

    Args:
        variance: σ² of the acceleration, m²/s⁴.
        noise: R of a velocity, m²/s².
        dt: s of a step.
    """
    q = dt * dt * variance
    return 0.5 * (q + math.sqrt(q * q + 4.0 * q * noise))
