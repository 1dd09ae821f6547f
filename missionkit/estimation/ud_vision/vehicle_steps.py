"""Prediction and update on U D Uᵀ; compiled, arrays are changed in place.

Layout and units are those of `error_state_ekf.state_layout`, with features as its landmarks. The
state x is in double precision, the factors in either. Corrections are small, so the covariance is
not turned with the attitude's error (Solà 2017, section 6.3, G = I).

Source: P4 section II-B.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.error_state_ekf.measurement_models import predict
from missionkit.estimation.error_state_ekf.process_model import move, rotate_by
from missionkit.estimation.error_state_ekf.replay import trace
from missionkit.estimation.error_state_ekf.state_layout import (
    ACCEPTED,
    AT,
    D_ACCEL_BIAS,
    D_ANGLE,
    D_LANDMARKS,
    END,
    EXTRA,
    GAP,
    NIS,
    NOISE,
    OUTCOME,
    REJECTED,
    RESIDUAL,
    Z,
)
from missionkit.estimation.error_state_ekf.update import sane
from missionkit.estimation.linear_algebra import inverted
from missionkit.estimation.ud_filter import factors
from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled

NOISES = 12  # velocity, angle, bias of the accelerometer, of the gyroscope, three axes each


@compiled
def transition(J: Mat, dt: float) -> Mat:
    """Return F (15, 15) of the vehicle's error from the rows J (6, 9) of `process_model.move`."""
    F = np.eye(D_LANDMARKS)
    for i in range(3):
        F[i, 3 + i] = dt
        for k in range(9):
            F[i, D_ANGLE + k] = 0.5 * dt * dt * J[i, k]
            F[3 + i, D_ANGLE + k] = dt * J[i, k]
            F[D_ANGLE + i, D_ANGLE + k] = J[3 + i, k]
    return F


@compiled
def propagate(x: Vec3, U: Mat, D: Vec3, u: Vec3, dt: float, noise: Vec3) -> None:
    """Advance state and factors by dt (s) within one inertial interval.

    `noise` (6,) holds variance densities: accelerometer, gyroscope, their biases, and the squares
    of what acceleration and turn rate may do unseen while samples are missing.

    Args:
        x: (16 + 3 N,) state, changed.
        U: (15 + 3 N, 15 + 3 N), changed.
        D: (15 + 3 N,), changed.
        u: (8,) inertial interval.
        dt: s, within the interval.
        noise: (6,), as above.
    """
    F = transition(move(x, u, dt), dt)
    G, q = np.zeros((D_LANDMARKS, NOISES)), np.empty(NOISES)
    for k in range(NOISES):
        G[3 + k, k] = 1.0
        q[k] = dt * noise[k // 3]
        if k < D_ANGLE:
            q[k] += dt * noise[4 + k // 3] * u[GAP]
    factors.predict_first(U, D, F.astype(D.dtype), G.astype(D.dtype), q.astype(D.dtype))


@compiled
def innovation(U: Mat, D: Vec3, H: Mat) -> Mat:
    """Return H P Hᵀ (m, m).

    Args:
        U: (n, n).
        D: (n,).
        H: (m, n), mostly zeros.
    """
    m, n = H.shape
    A, S = np.zeros((m, n)), np.zeros((m, m))
    for a in range(m):
        for i in range(n):
            if H[a, i] != 0.0:
                for j in range(i, n):
                    A[a, j] += H[a, i] * U[i, j]
        for b in range(a + 1):
            for j in range(n):
                S[a, b] += A[a, j] * D[j] * A[b, j]
            S[b, a] = S[a, b]
    return S


@compiled
def distance(U: Mat, D: Vec3, H: Mat, r: Vec3, variances: Vec3) -> float:
    """Return ε = rᵀ (H P Hᵀ + R)⁻¹ r, infinite where that is no covariance (P4, (19)).

    Args:
        U: (n, n).
        D: (n,).
        H: (m, n), mostly zeros.
        r: (m,) residuals.
        variances: (m,), R's diagonal.
    """
    S, nis = innovation(U, D, H), 0.0
    for a in range(len(r)):
        S[a, a] += variances[a]
    W, positive = inverted(S)
    for a in range(len(r)):
        for b in range(len(r)):
            nis += r[a] * W[a, b] * r[b]
    return nis if positive and 0.0 <= nis < math.inf else math.inf


@compiled
def correct(x: Vec3, U: Mat, D: Vec3, H: Mat, r: Vec3, variances: Vec3) -> None:
    """Take in residuals one after the other, and fold what they say into the state.

    Args:
        x: (16 + 3 N,) state, changed.
        U: (n, n), changed.
        D: (n,), changed.
        H: (m, n), their Jacobian.
        r: (m,), residuals.
        variances: (m,), of their noise, which is independent.
    """
    d, kind = D - D, D.dtype.type
    for a in range(len(r)):
        h, left = H[a].astype(D.dtype), kind(r[a])
        for i in range(len(d)):
            left -= h[i] * d[i]
        factors.update(d, U, D, h, left, kind(variances[a]))
    turn = np.empty(3)
    for i in range(3):
        x[i] += d[i]
        x[3 + i] += d[3 + i]
        turn[i] = d[D_ANGLE + i]
    rotate_by(x, turn)
    for i in range(D_ACCEL_BIAS, len(d)):
        x[i + 1] += d[i]


@compiled
def take(x: Vec3, U: Mat, D: Vec3, row: Vec3, gates: Vec3) -> None:
    """Correct by one row (21,) of the log unless its ε reaches gates[m]; the verdict is in it.

    Args:
        x: (16 + 3 N,) state, changed.
        U: (n, n), changed.
        D: (n,), changed.
        row: (21,), its verdict is written.
        gates: (4,), ε above which one of m numbers is refused.
    """
    row[OUTCOME], row[NIS] = REJECTED, math.inf
    if not sane(row[Z:EXTRA]):
        return
    H, r, variances = np.zeros((3, len(D))), np.zeros(3), np.empty(3)
    m = predict(x, row, H, r)
    for i in range(3):
        row[RESIDUAL + i] = r[i]
        variances[i] = row[NOISE + 4 * i]
    row[NIS] = distance(U, D, H[:m], r[:m], variances[:m])
    if row[NIS] < gates[m]:
        row[OUTCOME] = ACCEPTED
        correct(x, U, D, H[:m], r[:m], variances[:m])


@compiled
def advance(
    x: Vec3,
    U: Mat,
    D: Vec3,
    since: float,
    imu: Mat,
    rows: Mat,
    until: float,
    noise: Vec3,
    gates: Vec3,
) -> float:
    """Run to `until` (s), or as far as samples reach, each measurement at its time; return when.

    Args:
        x: (16 + 3 N,) state, changed.
        U: (n, n), changed.
        D: (n,), changed.
        since: s, where the state is.
        imu: (k, 8) inertial intervals.
        rows: (j, 21) measurements in order of time; verdicts are written.
        until: s.
        noise: (6,) of `propagate`.
        gates: (4,) of `take`.
    """
    t, e, i = since, 0, 0
    while True:  # one call of each step: the compiler copies them into here
        while e < len(rows) and rows[e, AT] <= t:
            take(x, U, D, rows[e], gates)
            e += 1
        while i < len(imu) and not t < imu[i, END]:  # nor is one that ends at no number
            i += 1
        if i == len(imu) or not t < until:
            return t
        stop = min(imu[i, END], until)
        if e < len(rows):
            stop = min(stop, rows[e, AT])
        propagate(x, U, D, imu[i], stop - t, noise)
        t = stop


@compiled
def foresee(x: Vec3, since: float, imu: Mat, track: Mat) -> None:
    """Carry the state alone along intervals (k, 8), and its poses into a track (k, 8).

    Args:
        x: (16 + 3 N,) state, changed.
        since: s, where it is.
        imu: (k, 8), the first may have begun before.
        track: (k, 8) of time, p and q, overwritten.
    """
    t = since
    for i in range(len(imu)):
        move(x, imu[i], imu[i, END] - t)
        t = imu[i, END]
        trace(x, t, track[i])
