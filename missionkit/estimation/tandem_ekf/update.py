"""The measurement update and the reset of the attitude error; compiled, in place.

Source: P3 section IV-D; Markley, "Attitude Error Representations for Kalman Filtering", 2003.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.linear_algebra import (
    exp,
    inverted,
    joseph,
    multiply,
    normalised,
    symmetrise,
    times_transposed,
    transpose,
)
from missionkit.estimation.tandem_ekf.state_layout import ALPHA, BETA, QUATERNION
from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled


@compiled
def squared(r: Vec3, W: Mat) -> float:
    """Return ε = rᵀ W r, W = S⁻¹: the squared Mahalanobis distance of a residual (m,)."""
    total = 0.0
    for i in range(len(r)):
        for k in range(len(r)):
            total += r[i] * W[i, k] * r[k]
    return total


@compiled
def innovation(P: Mat, H: Mat) -> Mat:
    """Return H P Hᵀ (m, m)."""
    return times_transposed(H, times_transposed(P, H).T.copy())


@compiled
def update(
    P: Mat, H: Mat, r: Vec3, R: Mat, gate: float, settings: Vec3
) -> tuple[Vec3, float, bool]:
    """Correct a covariance P (n, n) by one measurement; return the correction (n,), ε, and verdict.

        S = H P Hᵀ + R,   ε = rᵀ S⁻¹ r: refused unless ε < gate
        R := R + β H P Hᵀ  while tr H P Hᵀ > α tr R         (underweighting)
        K = P Hᵀ (H P Hᵀ + R)⁻¹,   d = K r,   P := (I - K H) P (I - K H)ᵀ + K R Kᵀ

    so that the gain has S = (1 + β) H P Hᵀ + R, and P is what that gain leaves. The gate knows of
    no underweighting: it lets 99.99 % of good data through, not more.

    Args:
        P: covariance, changed unless the measurement is refused.
        H: (m, n) Jacobian.
        r: (m,) residual, measured less predicted.
        R: (m, m) covariance of its noise.
        gate: limit of ε.
        settings: for α and β.

    Source: P3 section IV-D; Crassidis & Junkins, section 3.6; underweighting: Zanetti, DeMars &
    Bishop, "Underweighting Nonlinear Measurements", 2010.
    """
    m = len(r)
    B = times_transposed(P, H)
    E = times_transposed(H, B.T.copy())
    S, noise = E + R, R.copy()
    prior, given = 0.0, 0.0
    for i in range(m):
        prior += E[i, i]
        given += R[i, i]
    W, positive = inverted(S)
    nis = squared(r, W)
    if not (positive and 0.0 <= nis < gate):
        return np.zeros(len(P)), nis if positive else math.inf, False
    if prior > settings[ALPHA] * given:
        noise += settings[BETA] * E
        W, _ = inverted(S + settings[BETA] * E)
    K = times_transposed(B, W)
    joseph(P, K, H, noise)
    d = np.zeros(len(P))
    for c in range(len(P)):
        for i in range(m):
            d[c] += K[c, i] * r[i]
    return d, nis, True


@compiled
def times_row(P: Mat, work: Mat, to: int) -> None:
    """Put P Hᵀ into row `to` of work, of an H in its first row that sees δρ and δv alone.

    Args:
        P: (n, n).
        work: (·, n), its first row H.
        to: index of the row to overwrite, not 0.
    """
    for c in range(len(P)):
        total = 0.0
        for k in range(6):
            total += P[c, k] * work[0, k]
        work[to, c] = total


@compiled
def less_outer(P: Mat, work: Mat, a: int, b: int) -> None:
    """P := P - (row a)ᵀ (row b), of work.

    Args:
        P: (n, n), changed in place.
        work: (·, n).
        a: index of a row.
        b: index of a row.
    """
    for c in range(len(P)):
        for k in range(len(P)):
            P[c, k] -= work[a, c] * work[b, k]


@compiled
def update_scalar(
    P: Mat, work: Mat, residual: float, variance: float, gate: float, settings: Vec3
) -> tuple[float, bool]:
    """Correct as `update` does, by one number; return ε and the verdict.

    `work` (4, n) has H in its first row; the correction is put into the last. With b = P Hᵀ,
    (I - K H) P = P - K bᵀ, so that Joseph's form takes two products of vectors.

    Args:
        P: (n, n), changed unless the measurement is refused.
        work: H, and room for b, K, and the correction d.
        residual: measured less predicted.
        variance: R.
        gate: limit of ε.
        settings: for α and β.
    """
    prior = 0.0
    times_row(P, work, 1)
    for k in range(6):
        prior += work[0, k] * work[1, k]
    nis = residual * residual / (prior + variance)
    if not (prior >= 0.0 and 0.0 <= nis < gate):
        return nis, False
    if prior > settings[ALPHA] * variance:
        variance += settings[BETA] * prior
    for c in range(len(P)):
        work[2, c] = work[1, c] / (prior + variance)
    less_outer(P, work, 2, 1)
    times_row(P, work, 3)
    for c in range(len(P)):
        work[3, c] -= variance * work[2, c]
    less_outer(P, work, 3, 2)
    symmetrise(P)
    for c in range(len(P)):
        work[3, c] = work[2, c] * residual
    return nis, True


@compiled
def turn(x: Vec3, P: Mat, first: int, d: Vec3) -> None:
    """Fold δθ (3,), rad, into the quaternion and reset it: q := Exp(δθ) ⊗ q, P := G P Gᵀ.

    What is left, Exp(δθ') = Exp(δθ_true) Exp(-δθ), makes G = I + ½ [δθ]× in the rows and columns
    of the attitude, which begin at `first`; the sign is that of an error in the mother-ship's axes.

    Source: P3 section IV-D with Markley 2003, section "Reset"; Solà 2017, section 7.3.

    Args:
        x: (17,) state; its quaternion is changed.
        P: (n, n), changed in place.
        first: 6 in P of the compound filter, 0 in A of a tandem.
        d: (3,), rad, mother-ship's axes.
    """
    q = normalised(multiply(exp(d), x[QUATERNION : QUATERNION + 4]))
    for i in range(4):
        x[QUATERNION + i] = q[i]
    n = len(P)
    for _ in range(2):
        for c in range(n):
            a, b, e = P[first, c], P[first + 1, c], P[first + 2, c]
            P[first, c] += 0.5 * (d[1] * e - d[2] * b)
            P[first + 1, c] += 0.5 * (d[2] * a - d[0] * e)
            P[first + 2, c] += 0.5 * (d[0] * b - d[1] * a)
        transpose(P)
    symmetrise(P)


@compiled
def inject(x: Vec3, P: Mat, d: Vec3) -> None:
    """Fold a correction d (6,) or (9,) into the state, and reset the attitude error it may have.

    Args:
        x: (17,) state, changed in place.
        P: (6, 6) or (9, 9), as `d`; changed in place.
        d: δρ (m), δv (m/s), and δθ (rad) if there is one.
    """
    for i in range(6):
        x[i] += d[i]
    if len(d) > 6:
        turn(x, P, 6, d[6:9])
