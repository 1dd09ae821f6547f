"""Attitude from gyroscope, accelerometer and magnetometer: a complementary filter, compiled.

Source: R. Mahony, T. Hamel and J.-M. Pflimlin, "Nonlinear complementary filters on the special
orthogonal group", 2008, the explicit form with bias.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.error_state_ekf.state_layout import (
    ACCEL,
    END,
    GYRO,
)
from missionkit.estimation.linear_algebra import (
    exp,
    multiply,
    normalised,
    rotate,
    to_matrix,
    wrap,
)
from missionkit.geometry import GRAVITY, Mat, Vec3
from missionkit.jit import compiled

REST_TOLERANCE = 1.5
"""Specific force this close to gravity (m/s²) tells which way is up."""


@compiled
def lean(q: Vec3, bias: Vec3, accel: Vec3, gyro: Vec3, dt: float, gains: Vec3) -> None:
    """Turn q by one inertial interval and towards the accelerometer's vertical, in place.

        e = f/|f| × Rᵀ up,   b := b - k_i e dt,   q := q ⊗ Exp((ω_m - b + k_p e) dt)

    On average the specific force of a flight is that of rest, so the two agree in the end; how
    long that takes, k_p says. `gains` (2,) are k_p (1/s) and k_i (1/s²).

    Args:
        q: (4,) body to world, changed in place.
        bias: (3,) of the gyroscope, rad/s, FRD, changed in place.
        accel: (3,) specific force, m/s², FRD.
        gyro: (3,) turn rate, rad/s, FRD.
        dt: s.
        gains: (2,), k_p and k_i.
    """
    size = math.sqrt(accel[0] * accel[0] + accel[1] * accel[1] + accel[2] * accel[2])
    turn, e = np.empty(3), np.zeros(3)
    if abs(size - GRAVITY) < REST_TOLERANCE:
        R = to_matrix(q)
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            e[i] = (accel[k] * R[2, j] - accel[j] * R[2, k]) / size
    for i in range(3):
        bias[i] -= gains[1] * e[i] * dt
        turn[i] = (gyro[i] - bias[i] + gains[0] * e[i]) * dt
    turned = normalised(multiply(q, exp(turn)))
    for i in range(4):
        q[i] = turned[i]


@compiled
def steer(q: Vec3, bias: Vec3, field: Vec3, declination: float, dt: float, gains: Vec3) -> None:
    """Turn q about the vertical towards the magnetometer's north, in place.

    Args:
        q: (4,) body to world, changed in place.
        bias: (3,) of the gyroscope, rad/s, FRD, changed in place.
        field: (3,), body axes, of any length.
        declination: of magnetic from true north, rad, positive to the east.
        dt: s, since the field was last received.
        gains: (2,), k_p (1/s) and k_i (1/s²).
    """
    m = rotate(q, field)
    if not abs(m[0]) + abs(m[1]) > 1e-6:
        return
    miss = wrap(declination - math.atan2(m[1], m[0]))
    R = to_matrix(q)
    for i in range(3):
        bias[i] -= gains[1] * miss * dt * R[2, i]
    about = np.zeros(3)
    about[2] = min(gains[0] * dt, 1.0) * miss
    turned = normalised(multiply(exp(about), q))
    for i in range(4):
        q[i] = turned[i]


@compiled
def carry(
    q: Vec3, bias: Vec3, imu: Mat, since: float, gains: Vec3, pull: Vec3, rates: Vec3
) -> float:
    """Turn q through inertial intervals (k, 8: `state_layout`) from time `since`.

    Mean acceleration and turn rate are zero if no time passed.

    Args:
        q: (4,) body to world, changed in place.
        bias: (3,) of the gyroscope, rad/s, FRD, changed in place.
        imu: (k, 8) inertial intervals, by `state_layout`.
        since: s, where the first interval begins.
        gains: (2,), k_p (1/s) and k_i (1/s²).
        pull: (3,), m/s², NED, overwritten by the mean acceleration.
        rates: (3,), rad/s, FRD, overwritten by the mean turn rate without bias.

    Returns:
        Length of the intervals together, s.
    """
    before, total = since, 0.0
    for i in range(3):
        pull[i], rates[i] = 0.0, 0.0
    for n in range(len(imu)):
        dt = imu[n, END] - before
        before = imu[n, END]
        accel, gyro = imu[n, ACCEL : ACCEL + 3].copy(), imu[n, GYRO : GYRO + 3].copy()
        lean(q, bias, accel, gyro, dt, gains)
        force = rotate(q, accel)
        force[2] += GRAVITY
        total += dt
        for i in range(3):
            pull[i] += force[i] * dt
            rates[i] += (gyro[i] - bias[i]) * dt
    if total > 0.0:
        for i in range(3):
            pull[i] /= total
            rates[i] /= total
    return total
