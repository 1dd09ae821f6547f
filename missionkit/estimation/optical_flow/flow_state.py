"""Converts the optical-flow navigator's memory to the estimate that the rest of missionkit sees."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from missionkit.estimation import mahalanobis
from missionkit.estimation.error_state_ekf.state_layout import D_LANDMARKS
from missionkit.estimation.navigator import NavState
from missionkit.estimation.optical_flow.flow_memory import (
    AXIS_EAST,
    AXIS_NORTH,
    AXIS_UP,
    FlowMemory,
)
from missionkit.estimation.optical_flow.flow_parameters import FlowKalman
from missionkit.geometry import Mat, Vec3, vec
from missionkit.messages import Health, Target

HEIGHT_BY_RANGE_AGE = 1.0
"""s since the last range for which it still says how high the vehicle is."""


def state(
    known: FlowMemory, surveyed: Mapping[str, tuple[Vec3, float]], settings: FlowKalman
) -> NavState:
    """Return the estimate; targets are where they were surveyed.

    Args:
        known: memory of the filter.
        surveyed: place (3,), m, NED, and its deviation (m), of each target.
        settings: parameters of the filter.
    """
    (north, v_north), (east, v_east), (up, climb) = known.mu.tolist()
    sd = position_sd(known, settings.rate_bias_sd)
    return NavState(
        position=vec(north, east, -up),
        velocity=vec(v_north, v_east, -climb),
        attitude=known.attitude,
        rates=known.last[4:7] - known.bias,
        health=Health(
            aligned=known.aligned,
            diverged=known.aligned and diverged(known, sd, settings),
            gnss_at=None,
            vision_at=None,
            position_sd=sd,
            rejected=known.refused,
            placed=known.aligned,
            height_sd=height_sd(known, settings),
            mahalanobis=mahalanobis.current(known.distance, known.now),
        ),
        targets={
            name: Target(name, place.copy(), math.hypot(own, sd), None, None, None)
            for name, (place, own) in surveyed.items()
        },
        covariance=_covariance(known),
        correction=vec(0.0, 0.0, 0.0),
        late=0,
    )


def position_sd(known: FlowMemory, rate_bias_sd: float) -> float:
    """Return the standard deviation (m) of the worse horizontal axis.

    The filters know of white noise alone. A turn rate that is wrong by b passes for a velocity
    of b h: it adds b ∫ h dt. A height that is wrong by a share of it makes the velocity wrong by
    the same share: what that has come to while no range was heard is `slip`.
    """
    worst = max(float(known.S[axis, 0, 0]) for axis in (AXIS_NORTH, AXIS_EAST))
    return math.sqrt(worst + (rate_bias_sd * known.reach) ** 2 + known.slip**2)


def height_sd(known: FlowMemory, settings: FlowKalman) -> float:
    """Return the standard deviation (m) of the height.

    The barometer's offset drifts: without a range, averaging does not help.
    """
    drift = 0.0 if ranged(known) else settings.baro_sd
    return math.sqrt(max(float(known.S[AXIS_UP, 0, 0]), 0.0) + drift**2)


def ranged(known: FlowMemory) -> bool:
    """Say whether a range finder has recently measured the height."""
    return not known.in_air or (
        known.range_at is not None and known.now - known.range_at <= HEIGHT_BY_RANGE_AGE
    )


def slipped(known: FlowMemory, velocity: Vec3, settings: FlowKalman) -> float:
    """Return by how much (m, sd) the way since the last flow may be wrong for its height.

    Args:
        known: the memory before this flow was taken in, never longer than a second ago.
        velocity: (2,), m/s, that it says.
        settings: the filter's parameters.
    """
    height = float(known.mu[AXIS_UP, 0])
    if ranged(known) or not height > 0.0:
        return 0.0
    share = min(1.0, settings.baro_sd / height)
    return (
        share * math.hypot(*velocity.tolist()) * min(HEIGHT_BY_RANGE_AGE, known.now - known.flow_at)
    )


def diverged(known: FlowMemory, sd: float, settings: FlowKalman) -> bool:
    """Say whether the estimate must not be flown on.

    Args:
        known: memory of the filter.
        sd: m, horizontal.
        settings: parameters of the filter.
    """
    silence = known.now - float(known.last[0])
    blind = known.now - known.flow_at
    unranged = 0.0 if known.range_at is None or not known.in_air else known.now - known.range_at
    return (
        silence > settings.silent_after
        or blind > settings.blind_after
        or unranged > settings.blind_after
        or sd > settings.max_position_sd
    )


def _covariance(known: FlowMemory) -> Mat:
    """Return (15, 15) with the parts that the filters have; height's are those of down."""
    P = np.zeros((D_LANDMARKS, D_LANDMARKS))
    for axis in (AXIS_NORTH, AXIS_EAST, AXIS_UP):
        P[axis : axis + 4 : 3, axis : axis + 4 : 3] = known.S[axis]
    return P
