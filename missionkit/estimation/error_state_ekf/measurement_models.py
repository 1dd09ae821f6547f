"""Measurement models: predictions and their derivatives by the error state; compiled.

Source: P1 section 6.1, H and h; derivatives for the local angular error of Solà 2017, section 6.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.error_state_ekf.state_layout import (
    D_ANGLE,
    D_GYRO_BIAS,
    D_LANDMARKS,
    EXTERNAL,
    EXTERNAL_TURN,
    EXTRA,
    FIX,
    FIX_VELOCITY,
    FLOW,
    GYRO_BIAS,
    HEADING,
    HEIGHT,
    INDEX,
    KIND,
    LANDMARKS,
    RANGE,
    STILL,
    Z,
)
from missionkit.estimation.linear_algebra import (
    conjugate,
    exp,
    log,
    multiply,
    rotate,
    to_matrix,
    wrap,
)
from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled


@compiled
def predict_heading(x: Vec3, row: Vec3, H: Mat) -> float:
    """Fill the first row of H and return how far the field's direction is from the declination.

    h = atan2(e, n) of (n, e, ·) = R(q) m, so ∂h/∂δθ = (n ∂e - e ∂n) / (n² + e²), ∂ = -R [m]×.

    Args:
        x: (n + 1,) state.
        row: (21,) row of the measurement log, with the field m (3,), FRD.
        H: (3, n) Jacobian over the error state, written.
    """
    b = row[Z : Z + 3]
    R = to_matrix(x[6:10])
    m = rotate(x[6:10], b)
    flat = max(m[0] * m[0] + m[1] * m[1], 1e-12)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        north = R[0, k] * b[j] - R[0, j] * b[k]
        east = R[1, k] * b[j] - R[1, j] * b[k]
        H[0, D_ANGLE + i] = (m[0] * east - m[1] * north) / flat
    return wrap(row[EXTRA] - math.atan2(m[1], m[0]))


@compiled
def predict_sight(x: Vec3, row: Vec3, H: Mat, r: Vec3) -> None:
    """Fill H and r of a sighting, the target's place l in body axes.

    h = R(q)ᵀ (l - p), ∂h = R(q)ᵀ (δl - δp) + [h]× δθ: one sighting corrects vehicle and target.

    Args:
        x: (n + 1,) state.
        row: (21,) row of the measurement log, with the place (3,), m, FRD.
        H: (3, n) Jacobian over the error state, written.
        r: (3,) residual (m), written.
    """
    first = 3 * int(row[INDEX])
    R = to_matrix(x[6:10])
    h = np.zeros(3)
    for i in range(3):
        for j in range(3):
            h[i] += R[j, i] * (x[LANDMARKS + first + j] - x[j])
            H[i, j] = -R[j, i]
            H[i, D_LANDMARKS + first + j] = R[j, i]
        r[i] = row[Z + i] - h[i]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        H[i, D_ANGLE + j] = -h[k]
        H[i, D_ANGLE + k] = h[j]


@compiled
def predict_flow(x: Vec3, row: Vec3, H: Mat, r: Vec3) -> None:
    """Fill two rows of H and r of optical flow at the distance d = row[EXTRA].

    The measured velocity z (`flow_velocity.across`) had its turns taken out by the gyroscope, bias
    and all: with w = R(q)ᵀ v,  h = (w_x - d b_y, w_y + d b_x),  ∂w = R(q)ᵀ δv + [w]× δθ.

    Args:
        x: (n + 1,) state.
        row: (21,) row of the measurement log, with the velocity (2,), m/s, FRD.
        H: (3, n) Jacobian over the error state, written.
        r: (3,) residual (m/s), written.
    """
    R, d = to_matrix(x[6:10]), row[EXTRA]
    w = np.zeros(3)
    for i in range(3):
        for j in range(3):
            w[i] += R[j, i] * x[3 + j]
    for i in range(2):
        for j in range(3):
            H[i, 3 + j] = R[j, i]
    H[0, D_ANGLE + 1], H[0, D_ANGLE + 2] = -w[2], w[1]
    H[1, D_ANGLE], H[1, D_ANGLE + 2] = w[2], -w[0]
    H[0, D_GYRO_BIAS + 1], H[1, D_GYRO_BIAS] = -d, d
    r[0] = row[Z] - (w[0] - d * x[GYRO_BIAS + 1])
    r[1] = row[Z + 1] - (w[1] + d * x[GYRO_BIAS])


@compiled
def predict_range(x: Vec3, row: Vec3, H: Mat) -> float:
    """Fill the first row of H and return how far the range is from h = -p_z / R_33.

    ∂h = -δp_z / R_33 + p_z / R_33² (R_31 δθ_y - R_32 δθ_x).

    Args:
        x: (n + 1,) state.
        row: (21,) row of the measurement log, with the range (m).
        H: (3, n) Jacobian over the error state, written.
    """
    R = to_matrix(x[6:10])
    cosine = max(R[2, 2], 0.1)
    H[0, 2] = -1.0 / cosine
    H[0, D_ANGLE] = -x[2] / cosine**2 * R[2, 1]
    H[0, D_ANGLE + 1] = x[2] / cosine**2 * R[2, 0]
    miss: float = row[Z] + x[2] / cosine
    return miss


@compiled
def predict_turn(x: Vec3, row: Vec3, H: Mat, r: Vec3) -> None:
    """Fill H and r of an attitude q_m = Exp(z): r = Log(q* ⊗ q_m), ∂h = δθ.

    Args:
        x: (n + 1,) state.
        row: (21,) row of the measurement log, with the rotation vector (3,), rad.
        H: (3, n) Jacobian over the error state, written.
        r: (3,) residual (rad), written.
    """
    turn = log(multiply(conjugate(x[6:10]), exp(row[Z : Z + 3])))
    for i in range(3):
        H[i, D_ANGLE + i] = 1.0
        r[i] = turn[i]


@compiled
def predict(x: Vec3, row: Vec3, H: Mat, r: Vec3) -> int:
    """Fill the Jacobian H (3, n) and innovation r = z - h(x) (3,); return how many rows are used.

    Fix, external position: h = p. Velocity, standing still: h = v. Height: h = -p_z. The others:
    their own functions.

    Args:
        x: (16 + 3 m,) state.
        row: (21,) of the measurement log.
        H: (3, n), zero on entry; its first rows are written.
        r: (3,); as many are written.
    """
    kind = int(row[KIND])
    if kind in {FIX, EXTERNAL, FIX_VELOCITY, STILL}:
        part = 0 if kind in {FIX, EXTERNAL} else 3
        for i in range(3):
            H[i, part + i] = 1.0
            r[i] = row[Z + i] - x[part + i]
        return 3
    if kind == HEIGHT:
        H[0, 2] = -1.0
        r[0] = row[Z] + x[2]
        return 1
    if kind == HEADING:
        r[0] = predict_heading(x, row, H)
        return 1
    if kind == RANGE:
        r[0] = predict_range(x, row, H)
        return 1
    if kind == FLOW:
        predict_flow(x, row, H, r)
        return 2
    if kind == EXTERNAL_TURN:
        predict_turn(x, row, H, r)
    else:
        predict_sight(x, row, H, r)
    return 3
