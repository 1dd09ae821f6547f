"""Memory of the vision-aided inertial navigator."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.estimation.error_state_ekf import initialization
from missionkit.estimation.error_state_ekf.initialization import RestSamples
from missionkit.estimation.error_state_ekf.state_layout import IMU_WIDTH, LANDMARKS, LOG_WIDTH
from missionkit.estimation.mahalanobis import MeanDistance
from missionkit.estimation.ud_vision import feature_table
from missionkit.estimation.ud_vision.feature_table import FeatureTable
from missionkit.geometry import Mat, Vec3


class FilterState(NamedTuple):
    """Where the filter stands, which is behind the present: at the last frame."""

    at: float  # s
    x: Vec3  # (16 + 3 N,)
    U: Mat  # (15 + 3 N, 15 + 3 N)
    D: Vec3  # (15 + 3 N,)


class UdVisionMemory(NamedTuple):
    """All it knows; an immutable value."""

    now: float  # s, of the last observation
    heard: RestSamples  # until aligned
    last: Vec3  # (7,) newest inertial sample: time, accel, gyro
    state: FilterState | None  # None until aligned
    imu: Mat  # (k, 8) inertial intervals after the state
    rows: Mat  # (j, 21) measurements after the state
    table: FeatureTable
    ahead: Vec3  # (16 + 3 N,) the state carried to the newest inertial sample
    track: Mat  # (n, 8) time, position (NED, m), attitude
    in_air: bool = False  # by the autopilot's last report
    frame_at: float = -math.inf  # s, newest frame heard
    came_at: float = -math.inf  # s, when that was
    looked_at: float = -math.inf  # s, newest frame that was looked at
    sighted_at: float = -math.inf  # s, newest frame with enough features, or moment on the ground
    used_at: float | None = None  # s, newest frame with enough features
    used: int = 0  # features taken in from the newest frame
    refused: int = 0  # features refused in the newest frame
    late: int = 0  # frames and measurements that came too late
    distance: MeanDistance = MeanDistance()
    broken: bool = False  # the last step was left out, since its result was not finite


def begin(features: int) -> UdVisionMemory:
    """Return the memory before the first observation, with slots for so many features."""
    return UdVisionMemory(
        now=0.0,
        heard=initialization.begin(),
        last=np.array([-math.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        state=None,
        imu=np.empty((0, IMU_WIDTH)),
        rows=np.empty((0, LOG_WIDTH)),
        table=feature_table.begin(features),
        ahead=np.zeros(LANDMARKS + 3 * features),
        track=np.empty((0, 8)),
    )
