"""The run through past and present, each measurement at its own time; compiled, in place.

Layout and units are those of `state_layout`.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.error_state_ekf.process_model import propagate
from missionkit.estimation.error_state_ekf.state_layout import (
    ACCEPTED,
    AT,
    D_LANDMARKS,
    END,
    EXTRA,
    FORGET_TARGET,
    FORGET_VEHICLE,
    INDEX,
    KIND,
    LANDMARKS,
    OUTCOME,
    Z,
)
from missionkit.estimation.error_state_ekf.update import forget_vehicle, isolate, update
from missionkit.estimation.linear_algebra import rotate
from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled


@compiled
def take(x: Vec3, P: Mat, row: Vec3, gates: Vec3) -> None:
    """Carry out one row of the measurement log.

    Args:
        x: (n + 1,) state, changed in place.
        P: (n, n) covariance, changed in place.
        row: (21,) row of the log; its verdict is written.
        gates: ε above which a measurement is refused, by its number of rows.
    """
    if row[KIND] == FORGET_VEHICLE:
        forget_vehicle(P, row[EXTRA], row[Z : Z + 3])
        row[OUTCOME] = ACCEPTED
    elif row[KIND] == FORGET_TARGET:
        first = 3 * int(row[INDEX])
        arm = rotate(x[6:10], row[Z : Z + 3])
        for i in range(3):
            x[LANDMARKS + first + i] = x[i] + arm[i]
        isolate(P, D_LANDMARKS + first, row[EXTRA] * row[EXTRA])
        row[OUTCOME] = ACCEPTED
    else:
        update(x, P, row, gates)


@compiled
def sound(x: Vec3, P: Mat) -> bool:
    """Say whether state and covariance are finite and no variance is negative."""
    for v in x:
        if not abs(v) < math.inf:
            return False
    for i in range(len(P)):
        for j in range(len(P)):
            if not abs(P[i, j]) < math.inf:
                return False
        if P[i, i] < 0.0:
            return False
    return True


@compiled
def copy(x: Vec3, P: Mat, to_x: Vec3, to_P: Mat) -> None:
    """Copy a state and its covariance element by element, which compiles faster than slices.

    Args:
        x: state, or (n,) of any length.
        P: (n, n).
        to_x: as long as `x`.
        to_P: as large as `P`.
    """
    for i in range(len(x)):
        to_x[i] = x[i]
    for i in range(len(P)):
        for j in range(len(P)):
            to_P[i, j] = P[i, j]


@compiled
def trace(x: Vec3, t: float, pose: Vec3) -> None:
    """Write time, p and q into a row (8,) of the track.

    Args:
        x: (16 + 3 m,) state.
        t: s.
        pose: (8,), overwritten: s, m NED, body to world.
    """
    pose[0] = t
    for i in range(7):
        pose[1 + i] = x[i if i < 3 else 3 + i]


@compiled
def replay(
    first: int,
    times: Vec3,
    xs: Mat,
    Ps: Mat,
    imu: Mat,
    track: Mat,
    log: Mat,
    noise: Vec3,
    gates: Vec3,
) -> bool:
    """Run from snapshot `first` to the end, each measurement at its own time.

    Args:
        first: index of the snapshot to begin at.
        times: (s,), s, when the snapshots were taken.
        xs: (s, 16 + 3 m) states; those after `first` are written.
        Ps: (s, n, n) covariances; those after `first` are written.
        imu: (k, 8) inertial intervals.
        track: (k, 8), time, p and q at the end of each interval; written.
        log: (j, 21) measurements in order; outcome, ε and innovation are written.
        noise: densities of the process noise.
        gates: of ε, by kind of measurement.

    Returns:
        Whether the end is sound: finite, and no variance negative.
    """
    x, P, t = np.empty(len(xs[0])), np.empty(Ps[0].shape), times[first]
    copy(xs[first], Ps[first], x, P)
    slot, e = first + 1, 0
    while e < len(log) and log[e, AT] <= t:
        e += 1
    for i in range(len(imu)):
        while t < imu[i, END]:
            stop = imu[i, END]
            if e < len(log):
                stop = min(stop, log[e, AT])
            propagate(x, P, imu[i], stop - t, noise)
            t = stop
            while e < len(log) and log[e, AT] <= t:
                take(x, P, log[e], gates)
                e += 1
            trace(x, t, track[i])
        if slot < len(times) and times[slot] == t:
            copy(x, P, xs[slot], Ps[slot])
            slot += 1
    return sound(x, P)
