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

from missionkit.estimation.linear_algebra import inverted
from missionkit.estimation.tandem_ekf.feature_pattern import (
    agreeing,
    fuse_pattern,
    mean_of,
    seen_in_world,
    skewed,
)
from missionkit.estimation.tandem_ekf.state_layout import (
    ACCEL_DENSITY,
    ACCEPTED,
    AT,
    D_ANGLE,
    D_VELOCITY,
    FEATURE_VARIANCE,
    GATE_1,
    GATE_3,
    NIS,
    OUTCOME,
    RANGE_VARIANCE,
    SPOT,
    TIME,
    VELOCITY,
    Z,
)
from missionkit.estimation.tandem_ekf.update import (
    inject,
    innovation,
    squared,
    update,
    update_scalar,
)
from missionkit.geometry import Mat, Vec3
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
        K = skewed(y)
        for i in range(3):
            for k in range(3):
                H[i, D_ANGLE + k] = K[i, k]
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
