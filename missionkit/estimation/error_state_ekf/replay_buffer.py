"""The recent past, kept so that a measurement counts at the time it was taken.

A delayed measurement rewinds the filter to the last snapshot before it and runs everything since
then again, in order: the result is the one that punctual delivery would have given.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from missionkit.estimation.error_state_ekf import replay, state_layout
from missionkit.estimation.linear_algebra import conjugate, exp, log, multiply, normalised
from missionkit.frames import Timed
from missionkit.geometry import Mat, Transform, Vec3
from missionkit.jit import compiled

EXTRAPOLATION = 0.02
"""How far past the newest pose one is extrapolated (s), about a sample."""


class ReplayBuffer(NamedTuple):
    """Snapshots, inertial intervals, poses and measurements, oldest first; never changed."""

    times: Vec3  # (s,), s, of the snapshots
    xs: Mat  # (s, 16 + 3 m)
    Ps: Mat  # (s, 15 + 3 m, 15 + 3 m)
    imu: Mat  # (k, 8)
    track: Mat  # (k, 8) time, p, q at the end of each interval
    log: Mat  # (j, 21)


class ReplayResult(NamedTuple):
    """A history with something added, and what became of measurements."""

    history: ReplayBuffer
    decided: Mat  # (j, 21), rows accepted or rejected for the first time
    late: int  # rows older than the history, dropped
    sound: bool  # the newest state is finite and no variance is negative


def begin(at: float, x: Vec3, P: Mat) -> ReplayBuffer:
    """Return a history of one snapshot.

    Args:
        at: s.
        x: (n + 1,) state.
        P: (n, n) covariance.
    """
    imu = np.empty((0, state_layout.IMU_WIDTH))
    track = np.empty((0, 8))
    log = np.empty((0, state_layout.LOG_WIDTH))
    return ReplayBuffer(np.array([at]), x[None].copy(), P[None].copy(), imu, track, log)


def extended(
    past: ReplayBuffer, imu: Mat, rows: list[Vec3], noise: Vec3, gates: Vec3, keep: float
) -> ReplayResult:
    """Return the history with intervals (n, 8) and measurements added, and run up to its end.

    Args:
        past: the history so far, left as it is.
        imu: (n, 8), from the end of `past` on.
        rows: (21,) each, of any time.
        noise: (7,), for `kernels.propagate`.
        gates: (4,), for `kernels.update`.
        keep: how far back snapshots are kept (s).
    """
    past = _pruned(past, (imu[-1, state_layout.END] if len(imu) else past.times[-1]) - keep)
    fresh = [r for r in rows if r[state_layout.AT] > past.times[0]]
    first = len(past.times) - 1
    if fresh:
        log = np.concatenate((past.log, fresh))
        log = log[
            np.lexsort(
                (log[:, state_layout.INDEX], log[:, state_layout.KIND], log[:, state_layout.AT])
            )
        ]
        earliest = min(r[state_layout.AT] for r in fresh)
        first = min(first, int(past.times.searchsorted(earliest)) - 1)
    else:
        log = past.log.copy()
    waiting = log[:, state_layout.OUTCOME] == state_layout.PENDING
    now = _grown(past, imu, log)
    sound = replay.replay(first, *now, noise, gates)
    decided = log[waiting]
    return ReplayResult(
        now,
        decided[decided[:, state_layout.OUTCOME] != state_layout.PENDING],
        len(rows) - len(fresh),
        sound,
    )


def found(past: ReplayBuffer, row: Vec3) -> Vec3 | None:
    """Return the log's row (21,) of a measurement, with its outcome, None if it is not there."""
    rows = past.log[_same(past.log, row)]
    return rows[-1] if len(rows) else None


def outcome(past: ReplayBuffer, row: Vec3) -> int | None:
    """Return what became of a measurement, None if it is not in the history."""
    logged = found(past, row)
    return None if logged is None else int(logged[state_layout.OUTCOME])


def newest(past: ReplayBuffer, kinds: tuple[int, ...]) -> list[Vec3]:
    """Return the decided rows (21,) of the newest time at which one of the first kind was decided.

    The first kind comes first.
    """
    log = past.log
    decided = log[log[:, state_layout.OUTCOME] != state_layout.PENDING]
    first = decided[decided[:, state_layout.KIND] == kinds[0]]
    if not len(first):
        return []
    same = decided[decided[:, state_layout.AT] == first[-1, state_layout.AT]]
    return [r for kind in kinds for r in same[same[:, state_layout.KIND] == kind][:1]]


def pending(row: Vec3) -> Vec3:
    """Return a row (21,) of the log as it was before anything was decided."""
    fresh = row.copy()
    fresh[state_layout.OUTCOME :] = 0.0
    return fresh


def without(past: ReplayBuffer, rows: list[Vec3]) -> ReplayBuffer:
    """Return the history with these measurements struck from its log, to be submitted again."""
    struck = np.zeros(len(past.log), dtype=bool)
    for r in rows:
        struck |= _same(past.log, r)
    return past._replace(log=past.log[~struck])


def pose_at(past: ReplayBuffer, at: float) -> Transform | None:
    """Return body to world at `at` (s), None outside the history."""
    return pose_in(past.track, at)


def pose_in(track: Mat, at: float) -> Transform | None:
    """Return body to world at `at` (s), None outside a track (n, 8) of time, p and q."""
    if len(track) < 2 or not track[0, 0] <= at <= track[-1, 0] + EXTRAPOLATION:
        return None
    i = min(max(int(track[:, 0].searchsorted(at)), 1), len(track) - 1)
    pose = between(track[i - 1], track[i], at)
    return Transform(pose[3:7], pose[0:3])


@compiled
def between(before: Vec3, after: Vec3, at: float) -> Vec3:
    """Return p and q (7,) between two rows (8,) of the track, as `frames.between` does.

    Args:
        before: s, p, q.
        after: s, p, q, later.
        at: s; beyond the two it is extrapolated.
    """
    share = (at - before[0]) / (after[0] - before[0])
    turn = log(multiply(conjugate(before[4:8]), after[4:8]))
    q = normalised(multiply(before[4:8], exp(share * turn)))
    pose = np.empty(7)
    for i in range(3):
        pose[i] = before[1 + i] + share * (after[1 + i] - before[1 + i])
    for i in range(4):
        pose[3 + i] = q[i]
    return pose


def timed(pose: Vec3) -> Timed:
    """Return body to world, with its time, of a row (8,) of the track."""
    return Timed(float(pose[0]), Transform(pose[4:8], pose[1:4]))


def _grown(past: ReplayBuffer, imu: Mat, log: Mat) -> ReplayBuffer:
    times, xs, Ps, intervals, track, _ = past
    if len(imu) == 0:
        return ReplayBuffer(times, xs.copy(), Ps.copy(), intervals, track.copy(), log)
    return ReplayBuffer(
        np.concatenate((times, imu[-1:, state_layout.END])),
        np.concatenate((xs, xs[-1:])),
        np.concatenate((Ps, Ps[-1:])),
        np.concatenate((intervals, imu)),
        np.concatenate((track, imu)),
        log,
    )


def _pruned(past: ReplayBuffer, horizon: float) -> ReplayBuffer:
    cut = max(int(past.times.searchsorted(horizon, side="right")) - 1, 0)
    if cut == 0:
        return past
    since = past.times[cut]
    kept = int(past.imu[:, state_layout.END].searchsorted(since, side="right"))
    return ReplayBuffer(
        past.times[cut:],
        past.xs[cut:],
        past.Ps[cut:],
        past.imu[kept:],
        past.track[kept:],
        past.log[past.log[:, state_layout.AT].searchsorted(since, side="right") :],
    )


def _same(log: Mat, row: Vec3) -> npt.NDArray[np.bool_]:
    same: npt.NDArray[np.bool_] = (log[:, : state_layout.NOISE] == row[: state_layout.NOISE]).all(
        axis=1
    )
    return same
