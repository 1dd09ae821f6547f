"""Measurement models of ranges and feature points, compiled.

Which measurement corrects which filter is where tandem differs from compound:

- *A range* depends on the radio's place ρ, which is why ρ is the state: H = (∂h/∂ρ, 0, 0). The
  attitude, by which the lever arm P_1 turns, comes in through (1) in the prediction. The compound
  filter so has a covariance of δρ and δθ, and a range corrects its attitude too; in tandem it
  corrects the translation alone.
- *The points of a camera frame* are rotated into the mother-ship's axes, where their noise stays
  white and equal. Their differences do not depend on the place: they correct the attitude, exactly
  so in tandem. Their mean has an error independent of the differences' and depends on both; in
  tandem it corrects the translation, and the attitude's share in its error is noise that does not
  change from frame to frame (`lever_noise`).

So in tandem nothing is counted twice. Prediction and ranges give the same answers in both filters
where P has no covariance of δθ with the rest. Source: P3 sections III and IV; the split of a frame
is ours, the paper does not say how one measurement corrects two filters.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.linear_algebra import exp, inverted, multiply, rotate
from missionkit.estimation.tandem_ekf.process_model import cross
from missionkit.estimation.tandem_ekf.state_layout import (
    ACCEL_DENSITY,
    ACCEPTED,
    AT,
    CAMERA,
    D_ANGLE,
    D_VELOCITY,
    FEATURE_VARIANCE,
    GATE_1,
    GATE_3,
    LEVER,
    MOUNT,
    NIS,
    OUTCOME,
    QUATERNION,
    RANGE_VARIANCE,
    RATE,
    SPOT,
    TIME,
    VELOCITY,
    Z,
)
from missionkit.estimation.tandem_ekf.update import (
    inject,
    innovation,
    squared,
    turn,
    update,
    update_scalar,
)
from missionkit.geometry import Mat, Quat, Vec3
from missionkit.jit import compiled

NEAREST = 1e-3
"""Closer to an anchor (m) a range has no direction."""
LEAST_GAIN = 1e-6
"""Bound of the share of the prior's variance in `lever_noise`."""


@compiled
def delay_variance(lag: float, settings: Vec3) -> float:
    """Return what the place may have done unseen (m²) in a lag (s): q lag³ / 3."""
    return float(abs(lag * lag * lag) * settings[ACCEL_DENSITY] / 3.0)


@compiled
def fuse_range(x: Vec3, P: Mat, row: Vec3, settings: Vec3) -> None:
    """Correct by one range: h = |ρ - lag v - s|, H = (u, -lag u, 0), u the unit vector from s.

    A range that comes late by `lag` (s) is compared with where the radio was then.

    Args:
        x: (17,) state, changed in place.
        P: (9, 9) or, in tandem, (6, 6), changed in place.
        row: (10,); outcome and ε are written.
        settings: (22,), by `state_layout`.
    """
    lag = x[TIME] - row[AT]
    work, far = np.zeros((4, len(P))), 0.0
    for i in range(3):
        work[0, i] = x[i] - lag * x[VELOCITY + i] - row[SPOT + i]
        far += work[0, i] * work[0, i]
    far = math.sqrt(far)
    if far < NEAREST:
        return
    for i in range(3):
        work[0, i] /= far
        work[0, D_VELOCITY + i] = -lag * work[0, i]
    variance = settings[RANGE_VARIANCE] + delay_variance(lag, settings)
    row[NIS], accepted = update_scalar(P, work, row[Z] - far, variance, settings[GATE_1], settings)
    if accepted:
        row[OUTCOME] = ACCEPTED
        inject(x, P, work[3])


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
            H[:, first : first + 3] = skewed((sum_y - k * y[f]) * scale)
            residual = (sum_r - k * r[f]) * scale
            residual -= cross((sum_y - k * y[f]) * scale, total[first : first + 3])
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


@compiled
def lever_noise(P: Mat, A: Mat, y: Vec3, white: float) -> Mat:
    """Return R (3, 3), m², of the mean of a frame's points for the translation filter of a tandem.

        R = r I + λ B,   B = [y]× A [y]×ᵀ,   λ = (p + 3 r) / (p - b),   p = tr P_ρρ, b = tr B

    B is what the attitude's error does at the lever arm y (3,), m, the points' mean from the radio.
    It is the same error in every frame, so averaging must not shrink it: λ is the least weight for
    which the variance after the update is p (r' + b) / (p + r') with r' = 3 r, which tends to b
    and never goes below it. With λ = 1 a long look would.

    Args:
        P: (6, 6).
        A: (3, 3), rad², of δθ.
        y: (3,), m, mother-ship's axes.
        white: r, m², of the mean on each axis.
    """
    R = innovation(A, skewed(y))
    p, b = 0.0, 0.0
    for i in range(3):
        p += P[i, i]
        b += R[i, i]
    R *= (p + 3.0 * white) / max(p - b, LEAST_GAIN * p)
    for i in range(3):
        R[i, i] += white
    return R


@compiled
def mean_jacobian(n: int, y: Vec3, lag: float) -> Mat:
    """Return H (3, n) of a frame's mean point: (-I, lag I, [y]×), in tandem without the last.

    Args:
        n: 9, or 6 in tandem.
        y: (3,), m, mother-ship's axes.
        lag: s, age of the frame.
    """
    H = np.zeros((3, n))
    for i in range(3):
        H[i, i], H[i, D_VELOCITY + i] = -1.0, lag
    if n > D_ANGLE:
        H[:, D_ANGLE:] = skewed(y)
    return H


@compiled
def fuse_mean(
    x: Vec3, P: Mat, A: Mat, r: Vec3, y: Vec3, lag: float, white: float, settings: Vec3
) -> tuple[float, bool]:
    """Correct by the mean (3,) of a frame's points: r = -δρ + lag δv + y × δθ + noise.

    Returns ε and the verdict. Its noise has the variance `white` (m²) on each axis.

    Args:
        x: (17,) state, changed in place.
        P: (9, 9) or, in tandem, (6, 6), changed in place.
        A: (3, 3), rad², of δθ.
        r: (3,), m, mean residual.
        y: (3,), m, its lever arm.
        lag: s, age of the frame.
        white: m², variance of its noise on each axis.
        settings: (22,), by `state_layout`.
    """
    H = mean_jacobian(len(P), y, lag)
    R = white * np.eye(3) if len(P) > D_ANGLE else lever_noise(P, A, y, white)
    d, nis, accepted = update(P, H, r, R, settings[GATE_3], settings)
    if accepted:
        inject(x, P, d)
    return nis, accepted


@compiled
def fuse_frame(x: Vec3, P: Mat, A: Mat, rows: Mat, settings: Vec3) -> None:
    """Correct by the feature points of one camera frame, rows (N, 10).

    The mean has to pass the gate before the differences may turn anything.

    Args:
        x: (17,) state, changed in place.
        P: (9, 9) or, in tandem, (6, 6), changed in place.
        A: (3, 3) of δθ in tandem, else empty; changed in place.
        rows: (N, 10); outcome and ε are written.
        settings: (22,), by `state_layout`.
    """
    lag = x[TIME] - rows[0, AT]
    r, y = seen_in_world(x, lag, rows, settings)
    attitude, first = (P, D_ANGLE) if len(P) > D_ANGLE else (A, 0)
    block = attitude[first : first + 3, first : first + 3].copy()
    kept = agreeing(r, y, block, settings, rows)
    count = kept.sum()
    if count == 0.0:
        return
    white = settings[FEATURE_VARIANCE] / count + delay_variance(lag, settings)
    r0 = mean_of(r, kept)
    y0 = mean_of(y, kept) + r0
    S = innovation(P, mean_jacobian(len(P), y0, lag)) + white * np.eye(3)
    if len(P) == D_ANGLE:
        S += innovation(A, skewed(y0))
    W, positive = inverted(S)
    if not positive or not squared(r0, W) < settings[GATE_3]:
        for n in range(len(rows)):
            rows[n, NIS] = max(rows[n, NIS], settings[GATE_3])
        return
    fuse_pattern(x, attitude, first, r, y, kept, settings)
    r, y = seen_in_world(x, lag, rows, settings)
    r0 = mean_of(r, kept)
    y0 = mean_of(y, kept) + r0
    nis, accepted = fuse_mean(x, P, A, r0, y0, lag, white, settings)
    for n in range(len(rows)):
        rows[n, OUTCOME] = ACCEPTED * kept[n] if accepted else 0.0
        rows[n, NIS] = max(rows[n, NIS], nis)
