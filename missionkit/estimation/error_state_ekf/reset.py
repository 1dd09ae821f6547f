"""Decides when rejected measurements are accepted after all.

A jump of the satellite position is refused: velocity and inertial data carry the filter across a
short fault, and a lasting one is a lost position (`innovation_monitor.divergence`), since a
receiver that jumps in flight says where it is as well as one that does not. Refused fixes are
accepted if the filter itself is wrong: the velocities of the receiver were refused as long as
its positions, and the fixes agree with each other and with nothing visual against them. So they are
on the ground before arming, where nothing depends on the old place yet. Then the filter admits an
error as large as the disagreement and takes the same fix again. After an outage nothing of this is
needed: by then the filter's own uncertainty lets the fix through the gate. A target that is seen
again and again somewhere else is restarted at the place where it is seen.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.error_state_ekf import state_layout
from missionkit.estimation.error_state_ekf.innovation_monitor import (
    AGREEING,
    InnovationMonitor,
    refused_for,
)
from missionkit.estimation.error_state_ekf.measurement_log import row
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.error_state_ekf.state_layout import EXTERNAL, FIX, FIX_VELOCITY, SIGHT
from missionkit.geometry import Mat, Vec3, norm

ZERO_COVARIANCE = np.zeros((3, 3))


def agreeing(strays: Mat, count: int, sd: float) -> bool:
    """Say whether the last `count` of refused places (n, 3) scatter less than 3 `sd` (m).

    Args:
        strays: (n, 3), m, NED.
        count: how many of the last.
        sd: m, one axis.
    """
    if len(strays) < count:
        return False
    recent = strays[-count:]
    scatter = np.square(recent - recent.mean(axis=0)).sum(axis=1).mean()
    return math.sqrt(float(scatter)) <= 3.0 * sd


def straightened(strays: Mat) -> Mat:
    """Return how far (n, 3) refused fixes (n, 7) lie from the straight flight that fits best."""
    if not len(strays):
        return np.empty((0, 3))
    line, places = (
        np.column_stack((np.ones(len(strays)), strays[:, 0] - strays[0, 0])),
        strays[:, 1:4],
    )
    residual: Mat = places - line @ (np.linalg.pinv(line) @ places)
    return residual


def forget_vehicle(
    monitor: InnovationMonitor,
    fixes: list[Vec3],
    now: float,
    settings: VisualInertialEkf,
    *,
    parked: bool,
) -> Vec3 | None:
    """Return the log row that makes room for a fix, None if it is not accepted.

    Args:
        monitor: the counts.
        fixes: decided rows (21,) of the newest: the refused position, and its velocity if it has
            one.
        now: the time (s).
        settings: the limits.
        parked: the vehicle stands disarmed on the ground.
    """
    doubted = (FIX,) if parked else (FIX, FIX_VELOCITY)
    seen_ago = now - max(monitor.accepted_at[SIGHT], monitor.accepted_at[EXTERNAL])
    sd = math.sqrt(float(fixes[0][state_layout.NOISE : state_layout.EXTRA : 4].sum()))
    if (
        refused_for(monitor, doubted, now) < settings.reset_after
        or not (parked or monitor.refused[FIX_VELOCITY])
        or seen_ago < settings.blind_after
        or not agreeing(straightened(monitor.strays[-AGREEING:]), AGREEING, sd)
    ):
        return None
    drift = (0.0, 0.0, 0.0)
    misses = [norm(r[state_layout.RESIDUAL :]) for r in fixes]
    if refused_for(monitor, (FIX_VELOCITY,), now) > settings.blind_after:
        velocity_sd = settings.reset_velocity_sd + (misses[1] if len(misses) > 1 else 0.0)
        drift = (velocity_sd, settings.reset_angle_sd, settings.accel_bias_sd)
    at = float(fixes[0][state_layout.AT])
    return row(state_layout.FORGET_VEHICLE, at, drift, ZERO_COVARIANCE, extra=sd + misses[0])


def forget_target(sighting: Vec3) -> Vec3:
    """Return the log row that puts a target where the sighting's row (21,) has it.

    Its uncertainty becomes as large as its distance, and the same sighting then corrects it.
    """
    z = sighting[state_layout.Z : state_layout.NOISE]
    reach = float(np.linalg.norm(z))
    at, index = float(sighting[state_layout.AT]), int(sighting[state_layout.INDEX])
    return row(state_layout.FORGET_TARGET, at, z, ZERO_COVARIANCE, index, extra=max(reach, 1.0))
