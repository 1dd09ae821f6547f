"""Attitude of targets: the direction their markers face, and when they were seen."""

from __future__ import annotations

from typing import NamedTuple

from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.linear_algebra import (
    conjugate,
    exp,
    log,
    multiply,
    normalised,
)
from missionkit.geometry import Quat, Vec3


class TargetAttitude(NamedTuple):
    """The recursive estimate of one marker's attitude."""

    attitude: Quat | None = None  # (4,) marker to world
    variance: float = 0.0  # rad², each axis
    at: float = 0.0  # s, of the last sighting used
    rival: Quat | None = None  # (4,) another attitude, which refused sightings agree on
    support: int = 0  # refused sightings in a row that agree on the rival


def turned(
    facing: TargetAttitude,
    seen: Quat,
    variance: float,
    at: float,
    gate: float,
    settings: VisualInertialEkf,
) -> TargetAttitude:
    """Return the estimate with one more attitude `seen` (marker to world) taken in.

    The covariance-weighted mean on SO(3), a Kalman filter with one variance for three axes:
    φ = Log(q* ⊗ q_seen),  K = V / (V + R),  q := q ⊗ Exp(K φ),  V := (1 - K) V.
    Sightings with |φ|² / (V + R) >= `gate` are refused; when enough in a row agree with each
    other, the estimate starts again from them.  Source: Solà 2017, section 4; textbook Kalman.

    Args:
        facing: the estimate so far.
        seen: marker to world.
        variance: R, rad², one axis.
        at: s.
        gate: of φ² over its variance.
        settings: parameters of the filter.
    """
    if facing.attitude is None:
        return TargetAttitude(seen, variance, at)
    passed = max(at - facing.at, 0.0)
    prior = facing.variance + settings.target_turn_walk**2 * passed
    phi = log(multiply(conjugate(facing.attitude), seen))
    if float(phi @ phi) >= gate * (prior + variance):
        return _doubted(facing._replace(variance=prior, at=at), seen, variance, gate, settings)
    share = prior / (prior + variance)
    attitude = normalised(multiply(facing.attitude, exp(share * phi)))
    return TargetAttitude(attitude, (1.0 - share) * prior, max(at, facing.at))


def _doubted(
    facing: TargetAttitude, seen: Quat, variance: float, gate: float, settings: VisualInertialEkf
) -> TargetAttitude:
    rival, support = seen, 1
    if facing.rival is not None:
        phi: Vec3 = log(multiply(conjugate(facing.rival), seen))
        if float(phi @ phi) < gate * 2.0 * variance:
            support = facing.support + 1
            rival = normalised(multiply(facing.rival, exp(phi / support)))
    if support >= settings.relocate_after:
        return TargetAttitude(rival, variance, facing.at)
    return facing._replace(rival=rival, support=support)
