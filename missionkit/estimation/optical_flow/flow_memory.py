"""Memory of the optical-flow navigator."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.estimation.error_state_ekf import initialization
from missionkit.estimation.error_state_ekf.initialization import RestSamples
from missionkit.estimation.mahalanobis import MeanDistance
from missionkit.geometry import IDENTITY, Mat, Quat, Vec3, vec

AXIS_NORTH, AXIS_EAST, AXIS_UP = 0, 1, 2
"""Axes."""


class FlowMemory(NamedTuple):
    """All it knows; an immutable value."""

    now: float  # s, of the last observation
    heard: RestSamples  # until aligned
    aligned: bool
    last: Vec3  # (7,) newest inertial sample: time, accel, gyro
    attitude: Quat  # (4,) body to world
    bias: Vec3  # (3,), rad/s, of the gyroscope
    mu: Mat  # (3, 2), m and m/s: north, east, up
    S: Mat  # (3, 2, 2) covariances
    in_air: bool  # by the autopilot's last report
    mag_at: float | None  # s, last field received
    flow_at: float  # s, last flow used, or the last moment on the ground
    range_at: float | None  # s, of the last range taken in the air
    slip: float  # m, sd: what the flow's velocity is off by while no range says how high it is
    measured: Vec3 | None  # (2,), m/s, north and east by the flow of this observation
    refused: int  # flow samples in a row that could not be used
    reach: float  # m s, height summed over the time in the air: what a rate error counts for
    track: Mat  # (n, 8) time, position (NED, m), attitude, of the last observations
    distance: MeanDistance = MeanDistance()  # of the flow from what was expected


def begin() -> FlowMemory:
    """Return the memory before the first observation."""
    return FlowMemory(
        now=0.0,
        heard=initialization.begin(),
        aligned=False,
        last=np.array([-math.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        attitude=IDENTITY,
        bias=vec(0.0, 0.0, 0.0),
        mu=np.zeros((3, 2)),
        S=np.zeros((3, 2, 2)),
        in_air=False,
        mag_at=None,
        flow_at=0.0,
        range_at=None,
        slip=0.0,
        measured=None,
        refused=0,
        reach=0.0,
        track=np.empty((0, 8)),
    )
