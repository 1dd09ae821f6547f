"""The prediction, compiled: state and covariance along one inertial interval, in place.

Source: P3 section II, equations (1) and (3), and section IV-C. (2) is not needed: the gyroscope
measures the turn rate, and the mother-ship does not turn.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.error_state_ekf.state_layout import ACCEL, GAP, GYRO
from missionkit.estimation.linear_algebra import symmetrise, transpose
from missionkit.estimation.tandem_ekf.state_layout import (
    ACCEL_DENSITY,
    D_ANGLE,
    D_VELOCITY,
    FORCE,
    GAP_ACCEL,
    GAP_RATE,
    GYRO_DENSITY,
    LEVER,
    PLACE,
    QUATERNION,
    RATE,
    TIME,
    USE_FORCE,
    VELOCITY,
)
from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled

Triple = tuple[float, float, float]
Quadruple = tuple[float, float, float, float]


@compiled
def cross(a: Vec3, b: Vec3) -> Vec3:
    """Return a × b."""
    c = np.empty(3)
    c[0] = a[1] * b[2] - a[2] * b[1]
    c[1] = a[2] * b[0] - a[0] * b[2]
    c[2] = a[0] * b[1] - a[1] * b[0]
    return c


@compiled
def crossed(a: Triple, b: Triple) -> Triple:
    """Return a × b, of tuples: an array costs as much as all that a prediction computes."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled
def rotated(q: Quadruple, v: Triple) -> Triple:
    """Return R(q) v, v + 2 w (n × v) + 2 n × (n × v) with q = (w, n)."""
    n = (q[1], q[2], q[3])
    t = crossed(n, v)
    t = (2.0 * t[0], 2.0 * t[1], 2.0 * t[2])
    k = crossed(n, t)
    return v[0] + q[0] * t[0] + k[0], v[1] + q[0] * t[1] + k[1], v[2] + q[0] * t[2] + k[2]


@compiled
def exp_of(w: Triple, dt: float) -> Quadruple:
    """Return Exp(w dt) of a turn rate w (rad/s) and a time (s)."""
    half = 0.5 * dt
    a, b, c = half * w[0], half * w[1], half * w[2]
    angle = math.sqrt(a * a + b * b + c * c)
    s = 1.0 - angle * angle / 6.0 if angle < 1e-6 else math.sin(angle) / angle
    return math.cos(angle), s * a, s * b, s * c


@compiled
def turned_by(q: Quadruple, r: Quadruple) -> Quadruple:
    """Return q ⊗ r at unit length."""
    y = (
        q[0] * r[0] - q[1] * r[1] - q[2] * r[2] - q[3] * r[3],
        q[0] * r[1] + q[1] * r[0] + q[2] * r[3] - q[3] * r[2],
        q[0] * r[2] - q[1] * r[3] + q[2] * r[0] + q[3] * r[1],
        q[0] * r[3] + q[1] * r[2] - q[2] * r[1] + q[3] * r[0],
    )
    n = 1.0 / math.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2] + y[3] * y[3])
    return y[0] * n, y[1] * n, y[2] * n, y[3] * n


@compiled
def move(x: Vec3, u: Vec3, dt: float, settings: Vec3, j: Mat) -> None:
    """Advance the state x (17,) by dt (s) within one inertial interval u (8,).

    P3's (1), ρ̈_ij = ρ̈ + ω̇ × p + ω × (ω × p) with p = D P_1, is the derivative of
    ρ̇_ij = ρ̇ + ω × p. With ω and the specific force a constant over the interval it integrates to

        c = ω × p,   v_c = v - c₀
        ρ += v_c dt + ½ a dt² + p₁ - p₀,   v := v_c + a dt + c₁,   q := q ⊗ Exp(ω dt)

    where c₀ has the turn rate that ended the last interval, so that its jump ω̇ counts, and no
    derivative of the gyroscope is taken. Its noise times the lever arm, 0.04 mm/s, is neglected.

    All of a, p and c turn with the attitude, so that, δθ being in the mother-ship's axes,

        δρ += dt δv - j₀ × δθ,   δv -= j₁ × δθ,   δθ += noise
        j₀ = ½ a dt² + p₁ - p₀ - c₀ dt  (m),   j₁ = a dt + c₁ - c₀  (m/s)

    j (2, 3) is overwritten by j₀ and j₁.

    Args:
        x: (17,), changed in place.
        u: (8,), specific force (m/s²) and turn rate (rad/s), body.
        dt: s, at most the interval's length.
        settings: (22,), by `state_layout`.
        j: (2, 3), overwritten.
    """
    arm = (settings[LEVER], settings[LEVER + 1], settings[LEVER + 2])
    q0 = (x[QUATERNION], x[QUATERNION + 1], x[QUATERNION + 2], x[QUATERNION + 3])
    p0 = rotated(q0, arm)
    c0 = rotated(q0, crossed((x[RATE], x[RATE + 1], x[RATE + 2]), arm))
    w = (u[GYRO], u[GYRO + 1], u[GYRO + 2])
    half = exp_of(w, 0.5 * dt)
    middle = turned_by(q0, half)
    q1 = turned_by(middle, half)
    push = rotated(middle, (u[ACCEL], u[ACCEL + 1], u[ACCEL + 2]))
    p1 = rotated(q1, arm)
    c1 = rotated(q1, crossed(w, arm))
    for i in range(3):
        x[RATE + i], x[FORCE + i] = w[i], u[ACCEL + i]
        a = settings[USE_FORCE] * dt * push[i]
        j[0, i] = 0.5 * dt * a + p1[i] - p0[i] - dt * c0[i]
        j[1, i] = a + c1[i] - c0[i]
        x[PLACE + i] += dt * x[VELOCITY + i] + j[0, i]
        x[VELOCITY + i] += j[1, i]
    for i in range(4):
        x[QUATERNION + i] = q1[i]
    x[TIME] += dt


@compiled
def spread(P: Mat, j: Mat, dt: float) -> None:
    """P := (F P)ᵀ, with the F of `move`; of (6, 6) without the columns of δθ.

    Args:
        P: (9, 9) or, in tandem, (6, 6), changed in place.
        j: (2, 3) of `move`.
        dt: s.
    """
    n = len(P)
    for i in range(3):
        for c in range(n):
            P[i, c] += dt * P[3 + i, c]
    if n > D_ANGLE:
        for row in range(2):
            for i in range(3):
                a, b = (i + 1) % 3, (i + 2) % 3
                for c in range(n):
                    P[3 * row + i, c] -= j[row, a] * P[6 + b, c] - j[row, b] * P[6 + a, c]
    transpose(P)


@compiled
def predict(x: Vec3, P: Mat, A: Mat, u: Vec3, dt: float, settings: Vec3) -> None:
    """Advance state and covariances by dt (s): P := F P Fᵀ + Q.

    Q is that of white acceleration (m²/s³) and white turn rate (rad²/s), and of what goes unseen in
    an interval that is too long (u[GAP] > 0). In tandem, the columns of F that δθ has in the rows
    of δρ and δv count as noise that bounds theirs, 2 |j|² tr A in every direction; A itself only
    grows, since δθ does not move.

    Source: P3 section IV-C; Crassidis & Junkins, "Optimal Estimation of Dynamic Systems", 2nd ed.,
    section 3.6 (discrete prediction) and 7.2 (attitude).

    Args:
        x: (17,) state, changed in place.
        P: (9, 9) or, in tandem, (6, 6), changed in place.
        A: (3, 3) of δθ in tandem, else empty; changed in place.
        u: (8,), inertial interval.
        dt: s.
        settings: (22,), by `state_layout`.
    """
    j = np.empty((2, 3))
    move(x, u, dt, settings, j)
    spread(P, j, dt)
    spread(P, j, dt)
    symmetrise(P)
    density = settings[ACCEL_DENSITY] + settings[GAP_ACCEL] * u[GAP]
    wander = dt * (settings[GYRO_DENSITY] + settings[GAP_RATE] * u[GAP])
    place, velocity = density * dt * dt * dt / 3.0, density * dt
    if len(A) > 0:
        doubt = 2.0 * (A[0, 0] + A[1, 1] + A[2, 2])
        place += doubt * (j[0, 0] * j[0, 0] + j[0, 1] * j[0, 1] + j[0, 2] * j[0, 2])
        velocity += doubt * (j[1, 0] * j[1, 0] + j[1, 1] * j[1, 1] + j[1, 2] * j[1, 2])
    for i in range(3):
        k = D_VELOCITY + i
        P[i, i] += place
        P[k, k] += velocity
        P[i, k] += 0.5 * density * dt * dt
        P[k, i] = P[i, k]
        if len(A) > 0:
            A[i, i] += wander
        else:
            P[D_ANGLE + i, D_ANGLE + i] += wander
