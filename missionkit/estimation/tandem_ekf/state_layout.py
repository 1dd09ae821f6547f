"""Layout of the arrays of the free flyer's filters; SI units.

The state x (17,) is that of the radio: its place ρ (m) and velocity v (m/s) in the mother-ship's
frame, the attitude q (body to mother-ship), the body's turn rate ω (rad/s) and specific force
(m/s², both in body axes) that carried it here, and the time (s).

The error state is δρ, δv, δθ, where δq = q ⊗ q̂⁻¹ = Exp(δθ): δθ (rad) is in the axes of the
mother-ship. The compound filter has one covariance P (9, 9) of it. The tandem filters have P (6, 6)
of δρ, δv and A (3, 3) of δθ; A of the compound filter is empty.
"""

from __future__ import annotations

PLACE, VELOCITY, QUATERNION, RATE, FORCE, TIME = 0, 3, 6, 10, 13, 16
STATE_WIDTH = 17

D_PLACE, D_VELOCITY, D_ANGLE = 0, 3, 6
"""First index of each part of the error state."""

AT, KIND, Z, SPOT, OUTCOME, NIS = 0, 1, 2, 5, 8, 9
"""Columns of a measurement: time (s), kind, z (3,), place of the anchor or feature (3,) in the
mother-ship's frame (m), what became of it, and its squared Mahalanobis distance ε."""
ROW_WIDTH = 10

RANGE = -1.0
"""Kind of a range z[0] (m). Other kinds number camera frames: z (3,) is a feature point (m)."""

REFUSED, ACCEPTED = 0.0, 1.0
"""Outcomes."""

(
    LEVER,
    CAMERA,
    MOUNT,
    ACCEL_DENSITY,
    GYRO_DENSITY,
    RANGE_VARIANCE,
    FEATURE_VARIANCE,
    GATE_1,
    GATE_3,
    ALPHA,
    BETA,
    GAP_ACCEL,
    GAP_RATE,
    MAX_DELAY,
    USE_FORCE,
) = (0, 3, 6, *range(10, 22))
"""Columns of the settings (22,): radio and camera on the body (m), camera to body (quaternion),
variance densities (m²/s³, rad²/s), R of range and feature (m²), gates of ε, underweighting,
squares of what goes unseen while inertial samples are missing (m²/s⁴, rad²/s²), s, 0 or 1."""
SETTINGS_WIDTH = 22
