"""Converts the filter's memory to the estimate that the rest of missionkit sees."""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.error_state_ekf import innovation_monitor, moving_target
from missionkit.estimation.error_state_ekf.filter_memory import FilterMemory, TargetTrack
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.error_state_ekf.replay_buffer import ReplayBuffer
from missionkit.estimation.error_state_ekf.state_layout import (
    D_ANGLE,
    D_LANDMARKS,
    GYRO_BIAS,
    LANDMARKS,
)
from missionkit.estimation.navigator import NavState
from missionkit.geometry import IDENTITY, Mat, Vec3, vec
from missionkit.messages import Target


def aligned(
    known: FilterMemory, past: ReplayBuffer, names: tuple[str, ...], settings: VisualInertialEkf
) -> NavState:
    """Return the newest state of an aligned filter.

    Args:
        known: memory of the filter.
        past: its snapshots, the newest last.
        names: of the targets, in the order of the state.
        settings: parameters of the filter.
    """
    x, P = past.xs[-1], past.Ps[-1]
    sd = innovation_monitor.horizontal_sd(P, settings.fix_drift_sd)
    silence = known.now - float(past.times[-1])
    cause = innovation_monitor.divergence(known.monitor, sd, silence, known.now, settings)
    if known.missing:
        cause = f"no inertial samples for {known.missing:.1f} s: aligning again"
    if known.broken:
        cause = "the latest measurements left the filter numerically invalid"
    return NavState(
        position=x[0:3].copy(),
        velocity=x[3:6].copy(),
        attitude=x[6:10].copy(),
        rates=known.last[4:7] - x[GYRO_BIAS:LANDMARKS],
        health=innovation_monitor.health(
            known.monitor,
            sd,
            math.sqrt(max(P.item(2, 2), 0.0)),
            known.now,
            cause=cause,
            placed=innovation_monitor.placed(known.monitor, known.now, settings),
        ),
        targets={
            n: _target(n, i, x, P, known.tracks[i], known.now, settings)
            for i, n in enumerate(names)
        },
        covariance=P[:D_LANDMARKS, :D_LANDMARKS].copy(),
        correction=known.corrections[-1].transform.translation,
        late=known.monitor.late,
    )


def unaligned(
    names: tuple[str, ...], places: Mat, sds: Vec3, settings: VisualInertialEkf
) -> NavState:
    """Return zeros and identity, and the targets (m, 3) with their sds (m,) as surveyed.

    Args:
        names: of the targets.
        places: (m, 3), m, NED, as surveyed.
        sds: (m,), m, one axis.
        settings: parameters of the filter.
    """
    surveyed = zip(names, places, sds, strict=True)
    return NavState(
        position=vec(0.0, 0.0, 0.0),
        velocity=vec(0.0, 0.0, 0.0),
        attitude=IDENTITY,
        rates=vec(0.0, 0.0, 0.0),
        health=innovation_monitor.unaligned(settings),
        targets={n: Target(n, p.copy(), float(sd), None, None, None) for n, p, sd in surveyed},
        covariance=np.zeros((D_LANDMARKS, D_LANDMARKS)),
        correction=vec(0.0, 0.0, 0.0),
        late=0,
    )


def angle_variance(P: Mat) -> float:
    """Return the variance (rad²) of the body's attitude, mean over the axes."""
    x, y, z = P.diagonal()[D_ANGLE : D_ANGLE + 3].tolist()
    return float(x + y + z) / 3.0


def relative_sd(P: Mat, index: int) -> float:
    """Return the standard deviation (m) of l - p of a target, mean over the axes."""
    d = D_LANDMARKS + 3 * index
    total = sum(P.item(a, a) + P.item(d + a, d + a) - 2.0 * P.item(a, d + a) for a in range(3))
    return math.sqrt(max(total / 3.0, 0.0))


def _target(
    name: str,
    index: int,
    x: Vec3,
    P: Mat,
    track: TargetTrack,
    now: float,
    settings: VisualInertialEkf,
) -> Target:
    if track.motion is not None:
        return moving_target.target_of(name, track.motion, now, settings.moving_accel)
    place = x[LANDMARKS + 3 * index : LANDMARKS + 3 * index + 3].copy()
    attitude = track.facing.attitude
    angle_sd = None if attitude is None else math.sqrt(track.facing.variance + angle_variance(P))
    return Target(name, place, relative_sd(P, index), attitude, angle_sd, track.seen_at)
