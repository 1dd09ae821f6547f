"""The filter's pass over one observation, compiled: everything in the order of its time."""

from __future__ import annotations

import numpy as np

from missionkit.estimation.error_state_ekf.state_layout import ACCEL, END, GYRO, IMU_WIDTH
from missionkit.estimation.tandem_ekf.measurement_models import fuse_frame, fuse_range
from missionkit.estimation.tandem_ekf.process_model import predict
from missionkit.estimation.tandem_ekf.state_layout import (
    AT,
    FORCE,
    KIND,
    MAX_DELAY,
    RANGE,
    RATE,
    TIME,
)
from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled

BEYOND = 0.03
"""How far past the newest inertial sample the filter predicts (s), with the same turn rate."""


@compiled
def held(x: Vec3) -> Vec3:
    """Return an inertial interval (8,) with the turn rate and force of the last one."""
    u = np.zeros(IMU_WIDTH)
    for i in range(3):
        u[GYRO + i] = x[RATE + i]
        u[ACCEL + i] = x[FORCE + i]
    return u


@compiled
def reach(x: Vec3, P: Mat, A: Mat, u: Vec3, at: float, settings: Vec3) -> None:
    """Predict up to a time (s), if it is ahead.

    Args:
        x: (17,) state, changed in place.
        P: (9, 9) or, in tandem, (6, 6), changed in place.
        A: (3, 3) of δθ in tandem, else empty; changed in place.
        u: (8,), the inertial interval around `at`.
        at: s.
        settings: (22,), by `state_layout`.
    """
    if at > x[TIME]:
        predict(x, P, A, u, at - x[TIME], settings)


@compiled
def catch_up(x: Vec3, P: Mat, A: Mat, imu: Mat, k: int, at: float, settings: Vec3) -> int:
    """Predict to a time (s) with the intervals (n, 8) from number k on; return the next number.

    Past the last of them the turn rate is held for `BEYOND` at most.

    Args:
        x: (17,) state, changed in place.
        P: (9, 9) or, in tandem, (6, 6), changed in place.
        A: (3, 3) of δθ in tandem, else empty; changed in place.
        imu: (n, 8), in order of time.
        k: index of the first interval that has not ended.
        at: s.
        settings: (22,), by `state_layout`.
    """
    while k < len(imu) and imu[k, END] <= at:
        reach(x, P, A, imu[k], imu[k, END], settings)
        k += 1
    if k < len(imu):
        reach(x, P, A, imu[k], at, settings)
    elif at <= x[TIME] + BEYOND:
        reach(x, P, A, held(x), at, settings)
    return k


@compiled
def advance(x: Vec3, P: Mat, A: Mat, imu: Mat, rows: Mat, settings: Vec3) -> None:
    """Take in inertial intervals (k, 8) and measurements (n, 10), both in order of time, in place.

    Rows of one frame follow each other. A measurement that is older than the state by up to
    MAX_DELAY counts at its own time, along the velocity and turn rate of now; an older one, and one
    from beyond the newest inertial sample, is refused.

    Args:
        x: (17,) state, changed in place.
        P: (9, 9) or, in tandem, (6, 6), changed in place.
        A: (3, 3) of δθ in tandem, else empty; changed in place.
        imu: (k, 8).
        rows: (n, 10); outcome and ε are written.
        settings: (22,), by `state_layout`.
    """
    i, k = 0, 0
    while i < len(rows):
        at, last = rows[i, AT], i + 1
        k = catch_up(x, P, A, imu, k, at, settings)
        while last < len(rows) and rows[last, KIND] == rows[i, KIND] != RANGE:
            last += 1
        if -1e-9 <= x[TIME] - at <= settings[MAX_DELAY]:
            if rows[i, KIND] == RANGE:
                fuse_range(x, P, rows[i], settings)
            else:
                fuse_frame(x, P, A, rows[i:last], settings)
        i = last
    if k < len(imu):
        catch_up(x, P, A, imu, k, imu[len(imu) - 1, END], settings)
