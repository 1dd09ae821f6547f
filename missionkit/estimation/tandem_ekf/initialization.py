"""State, covariances and settings at the start, from the parameters."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import chdtri

from missionkit.estimation.tandem_ekf import state_layout
from missionkit.estimation.tandem_ekf.centre_of_mass import jacobian
from missionkit.estimation.tandem_ekf.parameters import Angles, FlyerEkf
from missionkit.estimation.tandem_ekf.state_layout import D_ANGLE, QUATERNION, RATE, STATE_WIDTH
from missionkit.geometry import Mat, Quat, Vec3, exp, multiply, normalised, rotate, vec


def turned(angles_deg: Angles) -> Quat:
    """Return R_x R_y R_z (4,): about x, then the new y, then the new z (deg)."""
    a, b, c = map(math.radians, angles_deg)
    first = multiply(exp(vec(a, 0.0, 0.0)), exp(vec(0.0, b, 0.0)))
    return normalised(multiply(first, exp(vec(0.0, 0.0, c))))


def settings_of(s: FlyerEkf) -> Vec3:
    """Return the settings (22,) of the kernels, as `state_layout` lists them."""
    gates = [float(chdtri(m, 1.0 - s.gate)) for m in (1, 3)]
    return np.array(
        [
            *s.radio,
            *s.camera,
            *turned(s.camera_attitude_deg).tolist(),
            *np.square([s.accel_noise, s.gyro_noise, s.range_sd, s.feature_sd]).tolist(),
            *gates,
            s.underweight_above,
            s.underweight,
            s.gap_accel**2,
            s.gap_rate**2,
            s.max_delay,
            float(s.use_accel),
        ]
    )


def start(s: FlyerEkf, *, compound: bool) -> tuple[Vec3, Mat, Mat]:
    """Return x (17,), P and A at rest at the start, which is known of the centre of mass.

    The radio's place is uncertain by the attitude's part too; tandem filters take that as noise.
    """
    x, lever = np.zeros(STATE_WIDTH), np.array(s.radio)
    x[QUATERNION:RATE] = turned(s.attitude_deg)
    x[0:3] = np.array(s.position) + rotate(x[QUATERNION:RATE], lever)
    x[state_layout.TIME] = -math.inf
    sds = np.repeat([s.position_sd, s.velocity_sd, math.radians(s.attitude_sd_deg)], 3)
    J = jacobian(x, lever, -1.0)
    P = J @ np.diag(np.square(sds)) @ J.T
    if compound:
        return x, P, np.empty((0, 0))
    return x, P[:D_ANGLE, :D_ANGLE].copy(), P[D_ANGLE:, D_ANGLE:].copy()
