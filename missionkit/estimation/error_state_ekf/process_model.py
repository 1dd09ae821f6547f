"""The prediction, compiled: state and covariance along one inertial interval, in place.

Source: P1 section 6.1 with Solà 2017, section 5 (local angular error). Layout and units are those
of `state_layout`. F itself is never formed, only its rows that are not 0, 1 or dt.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.error_state_ekf.state_layout import (
    ACCEL,
    ACCEL_BIAS,
    D_ACCEL_BIAS,
    D_ANGLE,
    D_GYRO_BIAS,
    D_LANDMARKS,
    END,
    GAP,
    GYRO,
    GYRO_BIAS,
)
from missionkit.estimation.linear_algebra import (
    exp,
    multiply,
    normalised,
    symmetrise,
    to_matrix,
    transpose,
)
from missionkit.geometry import GRAVITY, Mat, Vec3
from missionkit.jit import compiled

MAX_ACCEL, MAX_RATE = 500.0, 100.0
"""No inertial sample shows more than this (m/s², rad/s)."""


@compiled
def usable(sample: Vec3, after: float) -> bool:
    """Say whether an inertial sample (7,) is finite, possible, and later than a time (s)."""
    for i in range(1, 7):
        if not abs(sample[i]) < (MAX_ACCEL if i < 4 else MAX_RATE):
            return False
    return bool(after < sample[0] < math.inf)


@compiled
def intervals(samples: Mat, last: Vec3, max_gap: float) -> Mat:
    """Return (k, 8) intervals between usable samples (n, 7: time, accel, gyro) after `last`.

    Each has the mean of its two ends, and its length if that exceeds `max_gap` (s). `last` (7,)
    becomes the last usable sample.

    Args:
        samples: (n, 7), time (s), acceleration (m/s²) and turn rate (rad/s), FRD.
        last: (7,) last usable sample so far, overwritten.
        max_gap: s.
    """
    out = np.zeros((len(samples), 8))
    k = 0
    for sample in samples:
        if usable(sample, last[0]):
            length = sample[0] - last[0]
            out[k, END] = sample[0]
            out[k, GAP] = length if length > max_gap else 0.0
            for i in range(1, 7):
                out[k, i] = 0.5 * (sample[i] + last[i])
                last[i] = sample[i]
            last[0] = sample[0]
            k += 1
    return out[:k]


@compiled
def rotate_by(x: Vec3, turn: Vec3) -> None:
    """Q := q ⊗ Exp(turn) within the state x."""
    q = normalised(multiply(x[6:10], exp(turn)))
    for i in range(4):
        x[6 + i] = q[i]


@compiled
def move(x: Vec3, u: Vec3, dt: float) -> Mat:
    """Advance the state x by one inertial interval u and return its rows of the Jacobian.

        f = R(q ⊗ Exp(½ ω dt)) a,   a = a_m - b_a,   ω = ω_m - b_g
        p += v dt + ½ (f + g) dt²,  v += (f + g) dt,  q := q ⊗ Exp(ω dt)

    P1 section 6.1 with gravity's sign for NED and the attitude of mid-interval. Returns (6, 9):
    ∂f and ∂θ' over (δθ, δb_a, δb_g).

    Args:
        x: (n + 1,) state, changed in place.
        u: (8,) inertial interval, as `intervals` returns it.
        dt: s.
    """
    a, turn, half, back = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for i in range(3):
        a[i] = u[ACCEL + i] - x[ACCEL_BIAS + i]
        turn[i] = dt * (u[GYRO + i] - x[GYRO_BIAS + i])
        half[i], back[i] = 0.5 * turn[i], -turn[i]
    q = x[6:10]
    R = to_matrix(q)
    M = to_matrix(multiply(q, exp(half)))
    turned = to_matrix(exp(back))
    f = np.empty(3)
    for i in range(3):
        f[i] = M[i, 0] * a[0] + M[i, 1] * a[1] + M[i, 2] * a[2]
    J = np.zeros((6, 9))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for c in range(3):
            J[i, c] = f[k] * R[j, c] - f[j] * R[k, c]  # -[f]× R
            J[i, 3 + c] = -M[i, c]
            J[i, 6 + c] = 0.5 * dt * (f[j] * M[k, c] - f[k] * M[j, c])
            J[3 + i, c] = turned[i, c]
        J[3 + i, 6 + i] = -dt  # -dt (I - ½ [ω dt]×), the right Jacobian to first order
        J[3 + i, 6 + j] = -0.5 * dt * turn[k]
        J[3 + i, 6 + k] = 0.5 * dt * turn[j]
    f[2] += GRAVITY
    rotate_by(x, turn)
    for i in range(3):
        x[i] += dt * x[3 + i] + 0.5 * dt * dt * f[i]
        x[3 + i] += dt * f[i]
    return J


@compiled
def spread(P: Mat, J: Mat, dt: float) -> None:
    """P := (F P)ᵀ, with F built from dt and the rows J (6, 9) of `move`.

    Args:
        P: (n, n) covariance, changed in place.
        J: (6, 9), as `move` returns it.
        dt: s.
    """
    n = len(P)
    S = np.zeros((6, n))
    for i in range(6):
        for k in range(9):
            g = J[i, k]
            if g != 0.0:
                for c in range(n):
                    S[i, c] += g * P[D_ANGLE + k, c]
    for i in range(3):
        for c in range(n):
            P[i, c] += dt * P[3 + i, c] + 0.5 * dt * dt * S[i, c]
            P[3 + i, c] += dt * S[i, c]
            P[D_ANGLE + i, c] = S[3 + i, c]
    transpose(P)


@compiled
def propagate(x: Vec3, P: Mat, u: Vec3, dt: float, noise: Vec3) -> None:
    """Advance state and covariance by dt (s) within one inertial interval: P := F P Fᵀ + Q dt.

    `noise` (7,) holds variance densities: accelerometer, gyroscope, their biases, landmarks, and
    the squares of what acceleration and turn rate may do unseen while samples are missing.

    Args:
        x: (n + 1,) state, changed in place.
        P: (n, n) covariance, changed in place.
        u: (8,) inertial interval.
        dt: s, within the interval.
        noise: (7,) variance densities, as above.
    """
    J = move(x, u, dt)
    spread(P, J, dt)
    spread(P, J, dt)
    for i in range(3):
        P[3 + i, 3 + i] += dt * (noise[0] + noise[5] * u[GAP])
        P[D_ANGLE + i, D_ANGLE + i] += dt * (noise[1] + noise[6] * u[GAP])
        P[D_ACCEL_BIAS + i, D_ACCEL_BIAS + i] += dt * noise[2]
        P[D_GYRO_BIAS + i, D_GYRO_BIAS + i] += dt * noise[3]
    for i in range(D_LANDMARKS, len(P)):
        P[i, i] += dt * noise[4]
    symmetrise(P)
