"""Quaternion feedback: the torque that turns a body to an attitude and stops it there.

    τ = -k q_e sgn(q_e0) - d (ω - ω_ref) + I α_ref + ω × I ω,    q_e = q_ref⁻¹ ⊗ q

with τ in N·m, k in N·m, d in N·m·s, ω (body axes) in rad/s and I in kg m². In continuous time it is
stable from any attitude if K⁻¹ D is positive definite: here K = k and D = d are numbers above
zero. The sign takes the shorter way round. A torque that is held for a period T adds a condition:
near rest an axis is I θ'' = -d θ' - ½ k θ, and the poles of its sampled form

    [[1 - ¼ k T²/I, T - ½ d T²/I], [-½ k T/I, 1 - d T/I]]

have to lie inside the unit circle.

Source: Wie & Barba, "Quaternion Feedback for Spacecraft Large Angle Maneuvers", 1985; P3 section
IV-B.
"""

from __future__ import annotations

import numpy as np

from missionkit.geometry import Mat, Quat, Vec3, conjugate, cross, multiply
from missionkit.number_text import beside


def sampled(inertia: float, k: float, d: float, period: float) -> Mat:
    """Return the matrix (2, 2) by which angle and rate of an axis go on in one period (s).

    Args:
        inertia: of the axis, kg m².
        k: `attitude_gain`, N·m, on the vector part of the quaternion error.
        d: `rate_gain`, N·m·s.
        period: s.
    """
    T, g = period, period / inertia
    return np.array([[1.0 - 0.25 * k * T * g, T - 0.5 * d * T * g], [-0.5 * k * g, 1.0 - d * g]])


def instability(inertia: float, k: float, d: float, period: float) -> str:
    """Say why the loop of one axis would not come to rest; "" if it does.

    Args:
        inertia: of the axis, kg m².
        k: `attitude_gain`, N·m.
        d: `rate_gain`, N·m·s.
        period: s, of the control loop.
    """
    if not (k > 0.0 and d > 0.0):
        return "attitude_gain and rate_gain have to be above 0: K⁻¹ D must be positive definite"
    radius = float(np.abs(np.linalg.eigvals(sampled(inertia, k, d, period))).max())
    if radius < 1.0:
        return ""
    pole, _ = beside(radius, 1.0, 3)
    return (
        f"attitude_gain {k:g} N·m and rate_gain {d:g} N·m·s are unstable with an inertia of "
        f"{inertia:g} kg m² and a period of {period:g} s (largest pole {pole}, has to be "
        f"below 1): lower both, rate_gain to less than {2.0 * inertia / period:g}"
    )


def torque(
    attitude: Quat, rates: Vec3, reference: Quat, reference_rates: Vec3, k: float, d: float
) -> Vec3:
    """Return -k q_e sgn(q_e0) - d (ω - ω_ref) (3,), N·m, body axes.

    Args:
        attitude: (4,), body to world.
        rates: (3,), rad/s, body.
        reference: (4,), desired attitude.
        reference_rates: (3,), rad/s, in body axes.
        k: N·m.
        d: N·m·s.
    """
    e = multiply(conjugate(reference), attitude)
    sign = 1.0 if e[0] >= 0.0 else -1.0
    return -k * sign * e[1:4] - d * (rates - reference_rates)


def gyroscopic(inertia: Vec3, rates: Vec3) -> Vec3:
    """Return ω × I ω (3,), N·m, of principal moments (3,), kg m²."""
    return cross(rates, inertia * rates)
