"""Layout of the filter's arrays.

The state x (16 + 3 m,) is p, v, q, b_a, b_g and one position l per target, m of them. The error
state (15 + 3 m,), to which the covariance belongs, has a rotation vector in place of q:
δp, δv, δθ, δb_a, δb_g, δl, where δθ is local: R_true = R(q) Exp(δθ).
"""

from __future__ import annotations

POSITION, VELOCITY, QUATERNION, ACCEL_BIAS, GYRO_BIAS, LANDMARKS = 0, 3, 6, 10, 13, 16
"""First index of each part of the state."""

D_POSITION, D_VELOCITY, D_ANGLE, D_ACCEL_BIAS, D_GYRO_BIAS, D_LANDMARKS = 0, 3, 6, 9, 12, 15
"""First index of each part of the error state."""

# --- inertial intervals (n, 8), each up to its own time ------------------------------------------

END, ACCEL, GYRO, GAP = 0, 1, 4, 7
"""Columns: end (s), mean accel (3), mean gyro (3), length if samples are missing, else 0 (s)."""
IMU_WIDTH = 8

# --- measurements (n, 21), in order of time, then kind -------------------------------------------

AT, KIND, INDEX, Z, NOISE, EXTRA, OUTCOME, NIS, RESIDUAL = 0, 1, 2, 3, 6, 15, 16, 17, 18
"""Columns: time, kind, target, z (3), R (9), extra, what became of it, ε, innovation (3)."""
LOG_WIDTH = 21

FORGET_VEHICLE, FORGET_TARGET, FIX, FIX_VELOCITY, HEIGHT, HEADING, SIGHT = range(7)
FLOW, RANGE, STILL, EXTERNAL, EXTERNAL_TURN = range(7, 12)
"""Kinds. The two that forget make room in the covariance for what follows at the same time."""
KINDS = 12

PENDING, ACCEPTED, REJECTED = 0, 1, 2
"""Outcomes. A measurement is pending until inertial samples reach its time."""

LARGEST_MEASUREMENT = 1e6
"""No place or sensor reading is larger than this, in SI units."""
