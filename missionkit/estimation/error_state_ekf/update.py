"""The measurement update and resets of the covariance; compiled, arrays are changed in place.

Source: P1 section 6.1 with Solà 2017, section 6. Layout and units are those of `state_layout`.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.error_state_ekf.measurement_models import predict
from missionkit.estimation.error_state_ekf.process_model import rotate_by
from missionkit.estimation.error_state_ekf.state_layout import (
    ACCEPTED,
    D_ACCEL_BIAS,
    D_ANGLE,
    D_LANDMARKS,
    EXTRA,
    LARGEST_MEASUREMENT,
    NIS,
    NOISE,
    OUTCOME,
    REJECTED,
    RESIDUAL,
    Z,
)
from missionkit.estimation.linear_algebra import (
    inverted,
    joseph,
    symmetrise,
    times_transposed,
    transpose,
)
from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled


@compiled
def inject(x: Vec3, P: Mat, d: Vec3) -> None:
    """Fold the error state d (n,) into x and carry P over: δθ' = (I - ½ [δθ]×) δθ.

    Source: Solà 2017, section 6.3.

    Args:
        x: (n + 1,) state, changed in place.
        P: (n, n) covariance, changed in place.
        d: (n,) error state.
    """
    n = len(P)
    turn = d[D_ANGLE : D_ANGLE + 3]
    rotate_by(x, turn)
    for i in range(6):
        x[i] += d[i]
    for i in range(D_ACCEL_BIAS, n):
        x[i + 1] += d[i]
    for _ in range(2):
        for c in range(n):
            a, b, e = P[D_ANGLE, c], P[D_ANGLE + 1, c], P[D_ANGLE + 2, c]
            P[D_ANGLE, c] += 0.5 * (turn[2] * b - turn[1] * e)
            P[D_ANGLE + 1, c] += 0.5 * (turn[0] * e - turn[2] * a)
            P[D_ANGLE + 2, c] += 0.5 * (turn[1] * a - turn[0] * b)
        transpose(P)
    symmetrise(P)


@compiled
def sane(values: Vec3) -> bool:
    """Say whether all values are finite and none is absurdly large."""
    fine = True
    for v in values:
        fine = fine and abs(v) < LARGEST_MEASUREMENT
    return fine


@compiled
def update(x: Vec3, P: Mat, row: Vec3, gates: Vec3) -> None:
    """Correct by one measurement unless its ε = rᵀ S⁻¹ r reaches gates[m]; the verdict is in row.

    S = H P Hᵀ + R,  K = P Hᵀ S⁻¹,  P in Joseph form.  Source: P1 section 6.1, update. A scalar
    measurement has two empty rows in H and r, which change nothing.

    Args:
        x: (n + 1,) state, changed in place.
        P: (n, n) covariance, changed in place.
        row: (21,) row of the log.
        gates: ε above which a measurement is refused, by its number of rows m.
    """
    row[OUTCOME], row[NIS] = REJECTED, math.inf
    if not sane(row[Z:EXTRA]):
        return
    H = np.zeros((3, len(P)))
    r = np.zeros(3)
    m = predict(x, row, H, r)
    R = row[NOISE:EXTRA].copy().reshape(3, 3)
    B = times_transposed(P, H)
    S = times_transposed(H, B.T.copy())
    for i in range(3):
        for j in range(3):
            S[i, j] += R[i, j]
    W, positive = inverted(S)
    nis = 0.0
    for i in range(3):
        row[RESIDUAL + i] = r[i]
        for j in range(3):
            nis += r[i] * W[i, j] * r[j]
    row[NIS] = nis
    if positive and 0.0 <= nis < gates[m]:
        row[OUTCOME] = ACCEPTED
        K = times_transposed(B, W)
        joseph(P, K, H, R)
        inject(x, P, times_transposed(K, r.reshape(1, 3))[:, 0].copy())


@compiled
def isolate(P: Mat, first: int, variance: float) -> None:
    """Make three error states independent of all others, with the given variance.

    Args:
        P: (n, n) covariance, changed in place.
        first: index of the first of the three.
        variance: in the unit of the state, squared.
    """
    for i in range(first, first + 3):
        for c in range(len(P)):
            P[i, c] = P[c, i] = 0.0
        P[i, i] = variance


@compiled
def forget_vehicle(P: Mat, position_sd: float, drift: Vec3) -> None:
    """Admit that p is wrong by position_sd (m); unless drift[0] is 0, that v, θ, b_a are as well.

    With a good velocity the vehicle cannot have drifted so far: the origin of the satellite
    positions has moved, and targets that were ever seen from here move along: P += σ² T Tᵀ,
    T = I over δp and their δl. One that only the mission file knows has no covariance with p,
    and stays where it is; so do all if the velocity was wrong.

    Args:
        P: (n, n), changed in place.
        position_sd: m, on each axis.
        drift: (3,), standard deviations of v, θ and b_a (m/s, rad, m/s²); the first is 0: they are
            right.
    """
    n = len(P)
    moves = np.zeros(n)
    for c in range(n):
        if c < 3 or (c >= D_LANDMARKS and drift[0] == 0.0 and P[c, c % 3] != 0.0):
            moves[c] = position_sd
    for a in range(n):
        for b in range(a % 3, n, 3):
            P[a, b] += moves[a] * moves[b]
    if drift[0] > 0.0:
        isolate(P, 3, drift[0] * drift[0])
        for i in range(3):
            P[D_ANGLE + i, D_ANGLE + i] += drift[1] * drift[1]
            P[D_ACCEL_BIAS + i, D_ACCEL_BIAS + i] += drift[2] * drift[2]
