"""The pattern of a frame's feature points: which agree, and how they turn the attitude; compiled.

Differences of the points do not depend on the place, so they correct the attitude alone. Source: P3
sections III and IV.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.linear_algebra import exp, inverted, multiply, rotate
from missionkit.estimation.tandem_ekf.process_model import cross
from missionkit.estimation.tandem_ekf.state_layout import (
    CAMERA,
    D_ANGLE,
    FEATURE_VARIANCE,
    GATE_3,
    LEVER,
    MOUNT,
    NIS,
    QUATERNION,
    RATE,
    SPOT,
    VELOCITY,
    Z,
)
from missionkit.estimation.tandem_ekf.update import inject, innovation, squared, turn, update
from missionkit.geometry import Mat, Quat, Vec3
from missionkit.jit import compiled


@compiled
def seen_in_world(x: Vec3, lag: float, rows: Mat, settings: Vec3) -> tuple[Mat, Mat]:
    """Return residuals and lever arms (N, 3), m, of feature points, in the mother-ship's axes.

    With s the place of a feature, M the camera's attitude on the body and t its place, a point is
    z = Mᵀ (Dᵀ (s - ρ) + P_1 - t) + noise; rotated back by the estimate,

        D̂ M z - D̂ (P_1 - t) = Exp(-δθ) (s - ρ) + noise
        r = -δρ + y × δθ + noise,   y = s - ρ̂

    at the time of the frame, `lag` (s) ago. To the mean of the points belongs its lever arm as
    measured, y + r, which leaves an error of second order in δθ alone; differences of y are exact.

    Args:
        x: (17,) state.
        lag: s, not negative.
        rows: (N, 10), of one frame.
        settings: (22,), by `state_layout`.
    """
    back, offset = np.empty(3), np.empty(3)
    for i in range(3):
        back[i] = -lag * x[RATE + i]
        offset[i] = settings[LEVER + i] - settings[CAMERA + i]
    q = multiply(x[QUATERNION:RATE], exp(back))
    view: Quat = multiply(q, settings[MOUNT : MOUNT + 4])
    offset = rotate(q, offset)
    r, y = np.empty((len(rows), 3)), np.empty((len(rows), 3))
    for n in range(len(rows)):
        z = rotate(view, rows[n, Z : Z + 3])
        for i in range(3):
            y[n, i] = rows[n, SPOT + i] - x[i] + lag * x[VELOCITY + i]
            r[n, i] = z[i] - offset[i] - y[n, i]
    return r, y


@compiled
def skewed(y: Vec3) -> Mat:
    """Return [y]× (3, 3)."""
    K = np.zeros((3, 3))
    for i in range(3):
        a, b = (i + 1) % 3, (i + 2) % 3
        K[i, b], K[i, a] = y[a], -y[b]
    return K


@compiled
def mean_of(values: Mat, kept: Vec3) -> Vec3:
    """Return the mean (3,) of the kept of values (N, 3)."""
    total, count = np.zeros(3), 0.0
    for n in range(len(values)):
        count += kept[n]
        for i in range(3):
            total[i] += kept[n] * values[n, i]
    return total / max(count, 1.0)


@compiled
def agreeing(r: Mat, y: Mat, A: Mat, settings: Vec3, rows: Mat) -> Vec3:
    """Return which feature points (N,), 0 or 1, fit the pattern that the others make.

    While the worst of them fails the gate of 3 degrees of freedom, about the mean of those left, it
    is dropped; what is decided is put into rows. None is kept if that leaves half or fewer.

    Args:
        r: (N, 3), m, residuals of `seen_in_world`.
        y: (N, 3), m, their lever arms.
        A: (3, 3), rad², of δθ.
        settings: (22,), by `state_layout`.
        rows: (N, 10); ε is written.
    """
    count = len(r)
    kept = np.ones(count)
    while True:
        left = kept.sum()
        r0, y0 = mean_of(r, kept), mean_of(y, kept)
        worst, which = 0.0, -1
        for n in range(count):
            if kept[n] > 0.0:
                S = innovation(A, skewed(y[n] - y0))
                for i in range(3):
                    S[i, i] += settings[FEATURE_VARIANCE] * (1.0 - 1.0 / left)
                W, positive = inverted(S)
                rows[n, NIS] = squared(r[n] - r0, W) if positive else 0.0
                if rows[n, NIS] > worst:
                    worst, which = rows[n, NIS], n
        if worst < settings[GATE_3]:
            return kept
        kept[which] = 0.0
        if 2.0 * kept.sum() <= count:
            return np.zeros(count)


@compiled
def fuse_pattern(x: Vec3, P: Mat, first: int, r: Mat, y: Mat, kept: Vec3, settings: Vec3) -> Vec3:
    """Correct the attitude by the differences of the points; return the turn δθ (3,), rad.

    Of N points with white noise the N - 1 orthonormal contrasts (Helmert)
    c_k = (1, …, 1, -k, 0, …) / sqrt(k (k + 1)) have white noise again, and none sees δρ:
    r_k = y_k × δθ + noise.  All use one linearisation; the error is reset once, after the last.

    Args:
        x: state.
        P: covariance that holds the attitude's rows.
        first: where these begin.
        r: (N, 3), m, residuals.
        y: (N, 3), m, lever arms.
        kept: (N,), 0 or 1.
        settings: noise, gate and underweighting.
    """
    n = len(P)
    R, total = np.zeros((3, 3)), np.zeros(n)
    for i in range(3):
        R[i, i] = settings[FEATURE_VARIANCE]
    sum_r, sum_y, k = np.zeros(3), np.zeros(3), 0.0
    for f in range(len(r)):
        if kept[f] == 0.0:
            continue
        if k > 0.0:
            H, scale = np.zeros((3, n)), 1.0 / math.sqrt(k * (k + 1.0))
            arm = (sum_y - k * y[f]) * scale
            K = skewed(arm)
            for i in range(3):
                for c in range(3):
                    H[i, first + c] = K[i, c]
            residual = (sum_r - k * r[f]) * scale
            residual -= cross(arm, total[first : first + 3])
            d, _, _ = update(P, H, residual, R, math.inf, settings)
            total += d
        sum_r += r[f]
        sum_y += y[f]
        k += 1.0
    if n > D_ANGLE:
        inject(x, P, total)
    else:
        turn(x, P, first, total)
    return total[first : first + 3].copy()
