"""Converts the navigator's memory to the estimate that the rest of missionkit sees."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from missionkit.estimation import mahalanobis
from missionkit.estimation.error_state_ekf.state_layout import D_LANDMARKS, GYRO_BIAS, LANDMARKS
from missionkit.estimation.navigator import NavState
from missionkit.estimation.ud_vision.parameters import UdVisionEkf
from missionkit.estimation.ud_vision.ud_vision_memory import FilterState, UdVisionMemory
from missionkit.geometry import IDENTITY, Mat, Vec3, vec
from missionkit.messages import Health, Target

Surveyed = Mapping[str, tuple[Vec3, float]]


def state(known: UdVisionMemory, surveyed: Surveyed, settings: UdVisionEkf) -> NavState:
    """Return the estimate; targets are where they were surveyed.

    Args:
        known: memory of the navigator.
        surveyed: place (3,), m, NED, and its deviation (m), of each target.
        settings: its parameters.
    """
    if known.state is None:
        return _unaligned(surveyed)
    x, P = known.ahead, vehicle_covariance(known.state)
    away = math.hypot(*(x[:2] - settings.start).tolist())
    sd = math.hypot(_horizontal_sd(P), settings.iron_sd * away)
    cause = divergence(known, sd, settings)
    return NavState(
        position=x[0:3].copy(),
        velocity=x[3:6].copy(),
        attitude=x[6:10].copy(),
        rates=known.last[4:7] - x[GYRO_BIAS:LANDMARKS],
        health=Health(
            aligned=True,
            diverged=bool(cause),
            gnss_at=None,
            vision_at=known.used_at,
            position_sd=sd,
            rejected=known.refused,
            placed=known.now - known.came_at <= settings.blind_after,
            height_sd=math.sqrt(max(float(P[2, 2]), 0.0)),
            cause=cause,
            mahalanobis=mahalanobis.current(known.distance, known.now),
        ),
        targets=_targets(surveyed, sd),
        covariance=P,
        correction=vec(0.0, 0.0, 0.0),
        late=known.late,
    )


def divergence(known: UdVisionMemory, sd: float, settings: UdVisionEkf) -> str:
    """Return why the estimate must not be flown on, "" if it may be.

    Args:
        known: memory of the navigator.
        sd: of the horizontal position (m).
        settings: its parameters.
    """
    silence, blind = known.now - float(known.last[0]), known.now - known.sighted_at
    if silence > settings.silent_after:
        return f"no inertial samples for {silence:.1f} s"
    if known.broken:
        return "the latest measurements left the filter numerically invalid"
    if sd > settings.max_position_sd:
        return f"the position is only known to {sd:.0f} m"
    if known.in_air and blind > settings.blind_after:
        return _blindness(known, blind, settings)
    return ""


def _blindness(known: UdVisionMemory, blind: float, settings: UdVisionEkf) -> str:
    """Return why nothing was seen for so long (s)."""
    quiet, age = known.now - known.came_at, known.came_at - known.frame_at
    if not math.isfinite(quiet):
        return "no camera image"
    if quiet > settings.blind_after:
        return f"no camera image for {quiet:.1f} s"
    if age > settings.max_delay:
        return f"camera images arrive {age:.1f} s late"
    return f"{known.used} features of the ground found again, too few for {blind:.1f} s"


def vehicle_covariance(state: FilterState) -> Mat:
    """Return (15, 15) of δp, δv, δθ, δb_a, δb_g."""
    top = state.U[:D_LANDMARKS].astype(np.float64)
    P: Mat = (top * state.D) @ top.T
    return P


def _horizontal_sd(P: Mat) -> float:
    """Return the standard deviation (m) of the horizontal position along its worst direction."""
    (north, both), (_, east) = P[:2, :2].tolist()
    mean, half = 0.5 * (north + east), 0.5 * (north - east)
    return math.sqrt(max(mean + math.hypot(half, both), 0.0))


def _targets(surveyed: Surveyed, sd: float) -> dict[str, Target]:
    return {
        name: Target(name, place.copy(), math.hypot(own, sd), None, None, None)
        for name, (place, own) in surveyed.items()
    }


def _unaligned(surveyed: Surveyed) -> NavState:
    return NavState(
        position=vec(0.0, 0.0, 0.0),
        velocity=vec(0.0, 0.0, 0.0),
        attitude=IDENTITY,
        rates=vec(0.0, 0.0, 0.0),
        health=Health(
            aligned=False,
            diverged=False,
            gnss_at=None,
            vision_at=None,
            position_sd=0.0,
            rejected=0,
            placed=False,
        ),
        targets=_targets(surveyed, 0.0),
        covariance=np.zeros((D_LANDMARKS, D_LANDMARKS)),
        correction=vec(0.0, 0.0, 0.0),
        late=0,
    )
