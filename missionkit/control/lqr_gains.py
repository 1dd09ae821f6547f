"""Discrete LQR of one axis of a body that a force pushes: position, velocity and integral.

    z = (p - p_ref, v - v_ref, s),   z' = A z + B (f - m a_ref)
    A = [[1, T, 0], [0, 1, 0], [T, 0, 1]],   B = (½ T², T, 0) / m
    K = (R + Bᵀ X B)⁻¹ Bᵀ X A,   X = Q + Aᵀ X A - Aᵀ X B K        (the discrete Riccati equation)

with p in m, v in m/s, s = ∫ (p - p_ref) dt in m s, f in N, m in kg and T in s: K is in N/m, N s/m
and N/(m s).

Source: P3 section IV-B; Ogata, "Discrete-Time Control Systems", 2nd ed., chapter 8.
"""

from __future__ import annotations

import numpy as np

from missionkit.geometry import Mat, Vec3


def plant(mass: float, period: float) -> tuple[Mat, Mat]:
    """Return A (3, 3) and B (3, 1) of one axis, for a force held over `period` (s)."""
    A = np.array([[1.0, period, 0.0], [0.0, 1.0, 0.0], [period, 0.0, 1.0]])
    B = np.array([[0.5 * period * period], [period], [0.0]]) / mass
    return A, B


def gains(mass: float, period: float, weights: Vec3, effort: float) -> Vec3:
    """Return K (3,): N/m, N s/m, N/(m s).

    Args:
        mass: of the body (kg).
        period: between two commands (s).
        weights: (3,) diagonal of Q. A zero for the integral leaves it out.
        effort: R.
    """
    from scipy.linalg import solve_discrete_are  # noqa: PLC0415 - slow to import

    A, B = plant(mass, period)
    n = 3 if weights[2] > 0.0 else 2  # what costs nothing cannot be made stable
    A, B, Q = A[:n, :n], B[:n], np.diag(weights[:n])
    X = solve_discrete_are(A, B, Q, np.array([[effort]]))
    K = np.linalg.solve(effort + B.T @ X @ B, B.T @ X @ A)[0]
    return np.concatenate((K, np.zeros(3 - n)))


def spectral_radius(A: Mat, B: Mat, K: Vec3) -> float:
    """Return the largest modulus of the poles of A - B K: below 1, the loop is stable.

    Args:
        A: (3, 3), discrete.
        B: (3, 1), discrete.
        K: (3,), of u = -K x.
    """
    return float(np.abs(np.linalg.eigvals(A - B @ K[None, :])).max())
