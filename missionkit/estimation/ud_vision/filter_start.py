"""Where the navigator begins: at rest on the ground, and after a gap in the inertial samples."""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.error_state_ekf import initialization, realignment
from missionkit.estimation.error_state_ekf.initialization import RestSamples
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.error_state_ekf.state_layout import (
    ACCEL_BIAS,
    D_ACCEL_BIAS,
    D_LANDMARKS,
    GYRO_BIAS,
    LANDMARKS,
)
from missionkit.estimation.ud_filter import factors
from missionkit.estimation.ud_vision import feature_table
from missionkit.estimation.ud_vision.measurements import field_of
from missionkit.estimation.ud_vision.parameters import UdVisionEkf
from missionkit.estimation.ud_vision.ud_vision_memory import FilterState, UdVisionMemory
from missionkit.estimation.ud_vision.ud_vision_state import vehicle_covariance
from missionkit.geometry import Mat, Vec3, norm
from missionkit.messages import Magnetometer

START_SD = 0.01
"""m, how well the take-off point is known: it is the origin."""
UNKNOWN_SPEED = 5.0
"""m/s, standard deviation of a velocity that is not known."""


def started(at: float, x: Vec3, P: Mat, settings: UdVisionEkf) -> FilterState:
    """Return a state without features.

    Args:
        at: s.
        x: (16,) of the vehicle.
        P: (15, 15) its covariance.
        settings: parameters of the navigator.
    """
    more = 3 * settings.features
    whole = np.eye(D_LANDMARKS + more)
    whole[:D_LANDMARKS, :D_LANDMARKS] = P
    U, D = factors.factorised(whole)
    kind = np.float64 if settings.precision == "double" else np.float32
    return FilterState(at, np.append(x, np.zeros(more)), U.astype(kind), D.astype(kind))


def aligned(heard: RestSamples, settings: UdVisionEkf) -> FilterState | None:
    """Return where the filter starts, None while the vehicle moves or the field is unknown.

    Args:
        heard: the last seconds at rest, without fixes and heights.
        settings: parameters of the navigator.
    """
    s = settings
    rest = VisualInertialEkf(
        align_for=s.align_for,
        declination_deg=s.declination_deg,
        accel_noise=s.accel_noise,
        gyro_noise=s.gyro_noise,
        accel_bias_sd=s.accel_bias_sd,
        mag_sd=s.mag_sd,
        origin_sd=START_SD,
    )
    start = initialization.aligned(heard, np.empty((0, 3)), np.empty(0), rest)
    if start is None:
        return None
    start.x[:2] = s.start
    return started(start.at, start.x, start.P, s)


def resumed(
    known: UdVisionMemory,
    state: FilterState,
    samples: Mat,
    mag: Magnetometer | None,
    gap: float,
    settings: UdVisionEkf,
) -> UdVisionMemory:
    """Return the memory after a gap in the inertial samples: nothing is integrated across it.

    The attitude is what accelerometer and magnetometer say now, the velocity unknown, the position
    as uncertain as that velocity makes it over the gap, and every feature forgotten.

    Args:
        known: the memory before.
        state: its filter.
        samples: (n, 7), with what came after the gap.
        mag: the field now.
        gap: s.
        settings: parameters of the navigator.
    """
    fresh = samples[samples[:, 0] > known.last[0]]
    x, before = known.ahead[:LANDMARKS].copy(), vehicle_covariance(state)
    speed = UNKNOWN_SPEED + norm(x[3:6])
    P = np.zeros((D_LANDMARKS, D_LANDMARKS))
    P[D_ACCEL_BIAS:, D_ACCEL_BIAS:] = before[D_ACCEL_BIAS:, D_ACCEL_BIAS:]
    moved = before.diagonal()[:3] + (speed * gap) ** 2
    tilt = realignment.REALIGNED_TILT_SD**2
    np.fill_diagonal(P[:D_ACCEL_BIAS, :D_ACCEL_BIAS], (*moved, *[speed**2] * 3, *[tilt] * 3))
    x[3:6] = 0.0
    if (field := field_of(mag)) is not None:
        force = fresh[:, 1:4].mean(axis=0) - x[ACCEL_BIAS:GYRO_BIAS]
        north = math.radians(settings.declination_deg)
        x[6:10] = initialization.attitude(force, field, north)
    return known._replace(
        last=fresh[0].copy(),
        state=started(float(fresh[0, 0]), x, P, settings),
        imu=known.imu[:0],
        rows=known.rows[:0],
        table=feature_table.begin(settings.features),
        track=known.track[:0],
    )
