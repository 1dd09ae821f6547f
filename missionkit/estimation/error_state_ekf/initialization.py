"""Finding attitude, biases and position while the vehicle stands on the ground."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.error_state_ekf.state_layout import (
    D_ACCEL_BIAS,
    D_ANGLE,
    D_GYRO_BIAS,
    D_LANDMARKS,
    LANDMARKS,
)
from missionkit.geometry import GRAVITY, Mat, Quat, Vec3, from_euler, rotate, skew, to_matrix


class RestSamples(NamedTuple):
    """Sensor samples of the last few seconds at rest."""

    imu: Mat  # (n, 7) time, accel, gyro
    fixes: Mat  # (n, 7) time, position, its sd
    heights: Mat  # (n, 2) time, height
    fields: Mat  # (n, 4) time, magnetic field


class InitialState(NamedTuple):
    """State and covariance at the end of the alignment."""

    at: float  # s
    x: Vec3  # (16 + 3 m,)
    P: Mat  # (15 + 3 m, 15 + 3 m)


def begin() -> RestSamples:
    """Return an alignment without data."""
    return RestSamples(np.empty((0, 7)), np.empty((0, 7)), np.empty((0, 2)), np.empty((0, 4)))


def gathered(heard: RestSamples, new: RestSamples, span: float) -> RestSamples:
    """Return `heard` with `new` added, and all older than `span` (s) before its end dropped.

    Args:
        heard: samples so far.
        new: samples to add, later than all of `heard`.
        span: s to keep.
    """
    if len(new.imu) == 0:
        return heard
    since = new.imu[-1, 0] - span
    joined = (np.concatenate(pair) for pair in zip(heard, new, strict=True))
    return RestSamples(*(rows[rows[:, 0] >= since] for rows in joined))


def at_rest(heard: RestSamples, settings: VisualInertialEkf) -> bool:
    """Say whether the vehicle stood still for as long as alignment takes."""
    if len(heard.imu) < 2 or np.ptp(heard.imu[:, 0]) < 0.95 * settings.align_for:
        return False
    accel, gyro = heard.imu[:, 1:4], heard.imu[:, 4:7]
    weight = float(np.linalg.norm(accel.mean(axis=0)))
    return (
        float(accel.std(axis=0).max()) < settings.rest_accel
        and abs(weight - GRAVITY) < settings.rest_accel
        and float(np.abs(gyro.mean(axis=0)).max()) < settings.rest_rate
    )


def attitude(force: Vec3, field: Vec3, declination: float) -> Quat:
    """Return body to world of a body at rest, from specific force and magnetic field (FRD).

    roll = atan2(-f_y, -f_z), pitch = atan2(f_x, |(f_y, f_z)|); yaw turns the levelled field to
    the declination (rad).

    Args:
        force: (3,), m/s², FRD, mean specific force at rest.
        field: (3,), FRD, mean magnetic field, any unit.
        declination: rad, of the field, east of north.
    """
    roll = math.atan2(-force[1], -force[2])
    pitch = math.atan2(force[0], math.hypot(force[1], force[2]))
    level = rotate(from_euler(roll, pitch, 0.0), field)
    return from_euler(roll, pitch, declination - math.atan2(level[1], level[0]))


def aligned(
    heard: RestSamples, surveyed: Mat, surveyed_sd: Vec3, settings: VisualInertialEkf
) -> InitialState | None:
    """Return where the filter starts, None while the vehicle moves or the field is unknown.

    At rest the accelerometer shows b_a - Rᵀ g: the bias along gravity is found, across it the
    bias and the tilt cannot be distinguished, and the covariance shows it:
    δθ = [f]× δb_a / g², f the specific force.

    Args:
        heard: the last seconds.
        surveyed: (m, 3), m, NED, targets.
        surveyed_sd: (m,), m.
        settings: the filter's parameters.
    """
    if len(heard.fields) == 0 or not at_rest(heard, settings):
        return None
    force, rate = heard.imu[:, 1:4].mean(axis=0), heard.imu[:, 4:7].mean(axis=0)
    weight = float(np.linalg.norm(force))
    up = force / weight
    q = attitude(force, heard.fields[:, 1:].mean(axis=0), math.radians(settings.declination_deg))
    position, position_var = placed(heard, settings)
    x = np.concatenate([position, np.zeros(3), q, up * (weight - GRAVITY), rate, surveyed.ravel()])
    P = np.zeros((D_LANDMARKS + len(x) - LANDMARKS,) * 2)
    np.fill_diagonal(P[0:3, 0:3], position_var)
    np.fill_diagonal(P[3:6, 3:6], 0.05**2)
    _tilt_and_bias(P, up, settings)
    P[D_ANGLE : D_ANGLE + 3, D_ANGLE : D_ANGLE + 3] += _yaw_variance(q, settings.mag_sd)
    np.fill_diagonal(
        P[D_GYRO_BIAS:D_LANDMARKS, D_GYRO_BIAS:D_LANDMARKS],
        settings.gyro_noise**2 / settings.align_for + 1e-8,
    )
    np.fill_diagonal(P[D_LANDMARKS:, D_LANDMARKS:], np.repeat(surveyed_sd**2, 3))
    return InitialState(float(heard.imu[-1, 0]), x, P)


def placed(heard: RestSamples, settings: VisualInertialEkf) -> tuple[Vec3, Vec3]:
    """Return the mean position (3,), m, NED, by fixes and barometer, and its variances (3,)."""
    position, variance = np.zeros(3), np.full(3, settings.origin_sd**2)
    if len(heard.fixes):
        # Errors of successive fixes are alike, so their mean is no better than one of them.
        position = heard.fixes[:, 1:4].mean(axis=0)
        variance = np.maximum(heard.fixes[:, 4:7].mean(axis=0), 0.01) ** 2
    if len(heard.heights):
        share = variance[2] / (variance[2] + settings.baro_sd**2)
        position[2] += share * (-heard.heights[:, 1].mean() - position[2])
        variance[2] *= 1.0 - share
    return position, variance


def _tilt_and_bias(P: Mat, up: Vec3, settings: VisualInertialEkf) -> None:
    across = np.eye(3) - np.outer(up, up)
    noise = settings.accel_noise**2 / settings.align_for
    bias = settings.accel_bias_sd**2 * across + (noise + 1e-6) * np.outer(up, up)
    lean = skew(up) / GRAVITY
    angle, accel = slice(D_ANGLE, D_ANGLE + 3), slice(D_ACCEL_BIAS, D_ACCEL_BIAS + 3)
    P[accel, accel] = bias
    P[angle, accel] = lean @ bias
    P[accel, angle] = (lean @ bias).T
    P[angle, angle] = lean @ (bias + noise * across) @ lean.T + 1e-6 * np.eye(3)


def _yaw_variance(q: Quat, sd: float) -> Mat:
    down = to_matrix(q)[2]
    return sd**2 * np.outer(down, down)
