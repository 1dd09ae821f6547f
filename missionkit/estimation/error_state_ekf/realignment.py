"""Beginning again in the air, after inertial samples were missing for too long to integrate across.

What the vehicle did meanwhile is not known: the mean of the two samples at the ends of a gap, held
for seconds, turns the attitude by radians. So attitude, velocity and position begin as on the
ground, from accelerometer, magnetometer and fixes; biases and targets keep, less surely, what was
learnt. An autopilot that is left alone holds, so it is calm soon.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.error_state_ekf import initialization
from missionkit.estimation.error_state_ekf.initialization import InitialState, RestSamples
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.error_state_ekf.state_layout import (
    ACCEL_BIAS,
    D_ACCEL_BIAS,
    D_ANGLE,
    D_GYRO_BIAS,
    D_LANDMARKS,
    GYRO_BIAS,
    LANDMARKS,
)
from missionkit.geometry import GRAVITY, Mat, Vec3

SAMPLE_TIME = 1.0
"""s of samples that attitude and position are taken from."""
CALM_RATE = 0.1
"""rad/s, mean turn rate about each axis over `SAMPLE_TIME`, above which no attitude is taken."""
REALIGNED_TILT_SD = 0.2
"""rad: a steady acceleration of 2 m/s² tilts the specific force so far from the vertical."""


def gap(samples: Mat, last: Vec3) -> float:
    """Return how long (s) before the first of the samples (n, 7) that is newer `last` (7,) is."""
    since = float(last[0])
    for row in samples.tolist():
        if row[0] > since and all(map(math.isfinite, row)):
            return float(row[0] - since)
    return 0.0


def begun(
    heard: RestSamples, x: Vec3, P: Mat, missing: float, settings: VisualInertialEkf
) -> InitialState | None:
    """Return where the filter begins again, None while the vehicle is not calm.

    Args:
        heard: the last `SAMPLE_TIME` seconds.
        x: (16 + 3 m,) the state before the gap.
        P: (15 + 3 m, 15 + 3 m) its covariance.
        missing: since that state (s).
        settings: the filter's parameters.
    """
    if len(heard.fields) == 0 or not _calm(heard, x, settings):
        return None
    s, biases, targets = settings, slice(D_ACCEL_BIAS, D_LANDMARKS), slice(D_LANDMARKS, None)
    force = heard.imu[:, 1:4].mean(axis=0) - x[ACCEL_BIAS:GYRO_BIAS]
    field = heard.fields[:, 1:].mean(axis=0)
    y, S = x.copy(), np.zeros_like(P)
    y[3:6] = 0.0
    y[6:10] = initialization.attitude(force, field, math.radians(s.declination_deg))
    moved = np.full(3, (s.reset_velocity_sd * SAMPLE_TIME) ** 2)
    if len(heard.fixes):
        y[0:3], variance = initialization.placed(heard, s)
        moved += variance
    else:
        moved = P.diagonal()[0:3] + (s.reset_velocity_sd * missing) ** 2 + x[3:6] ** 2 * missing**2
    np.fill_diagonal(S[0:3, 0:3], moved)
    np.fill_diagonal(S[3:6, 3:6], s.reset_velocity_sd**2)
    np.fill_diagonal(S[D_ANGLE:D_ACCEL_BIAS, D_ANGLE:D_ACCEL_BIAS], REALIGNED_TILT_SD**2)
    S[biases, biases] = P[biases, biases]
    S[targets, targets] = P[targets, targets]
    grown = S.diagonal().copy()
    grown[D_ACCEL_BIAS:D_GYRO_BIAS] += s.accel_bias_walk**2 * missing
    grown[D_GYRO_BIAS:D_LANDMARKS] += s.gyro_bias_walk**2 * missing
    grown[D_LANDMARKS:] += s.target_walk**2 * missing
    np.fill_diagonal(S, grown)
    return InitialState(float(heard.imu[-1, 0]), y, S)


def _calm(heard: RestSamples, x: Vec3, settings: VisualInertialEkf) -> bool:
    if len(heard.imu) < 2 or np.ptp(heard.imu[:, 0]) < 0.95 * SAMPLE_TIME:
        return False
    force = heard.imu[:, 1:4].mean(axis=0) - x[ACCEL_BIAS:GYRO_BIAS]
    rate = heard.imu[:, 4:7].mean(axis=0) - x[GYRO_BIAS:LANDMARKS]
    weight = float(np.linalg.norm(force))
    return abs(weight - GRAVITY) < settings.rest_accel and float(np.abs(rate).max()) < CALM_RATE
