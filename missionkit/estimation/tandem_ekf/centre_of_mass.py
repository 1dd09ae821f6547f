"""From the radio's state to that of the centre of mass, and back at the start; compiled."""

from __future__ import annotations

import numpy as np

from missionkit.estimation.error_state_ekf.state_layout import D_LANDMARKS
from missionkit.estimation.linear_algebra import rotate, to_matrix
from missionkit.estimation.tandem_ekf.feature_pattern import skewed
from missionkit.estimation.tandem_ekf.process_model import cross
from missionkit.estimation.tandem_ekf.state_layout import D_ANGLE, QUATERNION, RATE, VELOCITY
from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled


@compiled
def jacobian(x: Vec3, lever: Vec3, sign: float) -> Mat:
    """Return (9, 9): errors of the centre of mass over those of the radio (sign 1), or back (-1).

    δρ_c = δρ + p × δθ,   δv_c = δv + c × δθ,   p = D P_1,   c = D (ω × P_1)

    Args:
        x: (17,) state of the radio.
        lever: P_1 (3,), m, body: from the centre of mass to the radio.
        sign: 1 or -1.
    """
    J = np.eye(9)
    J[0:3, D_ANGLE:] = sign * skewed(rotate(x[QUATERNION:RATE], lever))
    c = rotate(x[QUATERNION:RATE], cross(x[RATE : RATE + 3], lever))
    J[3:6, D_ANGLE:] = sign * skewed(c)
    return J


@compiled
def whole(P: Mat, A: Mat) -> Mat:
    """Return the covariance (9, 9) of δρ, δv, δθ; tandem filters leave the rest of it zero."""
    full = np.zeros((9, 9))
    full[: len(P), : len(P)] = P
    if len(A) > 0:
        full[D_ANGLE:, D_ANGLE:] = A
    return full


@compiled
def centre(x: Vec3, P: Mat, A: Mat, lever: Vec3) -> tuple[Vec3, Mat]:
    """Return place (m) and velocity (m/s) of the centre of mass (6,), and `NavState`'s covariance.

        ρ = ρ_ij - p,   ρ̇ = ρ̇_ij - ω × p     (P3 section IV-B: the kinematic relationship)

    In the covariance (15, 15) δθ is in body axes, as everywhere else in missionkit; the biases,
    which these filters do not have, are zero.

    Args:
        x: (17,) state of the radio.
        P: (9, 9) or, in tandem, (6, 6).
        A: (3, 3) of δθ in tandem, else empty.
        lever: P_1 (3,), m, body: from the centre of mass to the radio.

    Returns:
        m and m/s in the mother-ship's frame; SI.
    """
    y = np.empty(6)
    q = x[QUATERNION:RATE]
    p = rotate(q, lever)
    c = rotate(q, cross(x[RATE : RATE + 3], lever))
    for i in range(3):
        y[i], y[3 + i] = x[i] - p[i], x[VELOCITY + i] - c[i]
    J = jacobian(x, lever, 1.0)
    J[D_ANGLE:, D_ANGLE:] = to_matrix(q).T
    covariance = np.zeros((D_LANDMARKS, D_LANDMARKS))
    covariance[:9, :9] = J @ whole(P, A) @ J.T
    return y, covariance


@compiled
def sound(x: Vec3, P: Mat, A: Mat) -> bool:
    """Say whether all of a result is finite and no variance is negative.

    Args:
        x: any array.
        P: square.
        A: square, or empty.
    """
    fine = bool(np.isfinite(x).all() and np.isfinite(P).all() and np.isfinite(A).all())
    for i in range(len(P)):
        fine = fine and P[i, i] >= 0.0
    for i in range(len(A)):
        fine = fine and A[i, i] >= 0.0
    return fine
