"""Memory of the free flyer's navigator between observations."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.estimation.mahalanobis import MeanDistance
from missionkit.estimation.tandem_ekf.acceptance import Acceptance
from missionkit.estimation.tandem_ekf.centre_of_mass import centre
from missionkit.geometry import Mat, Vec3


class FlyerMemory(NamedTuple):
    """All the navigator knows; an immutable value."""

    now: float  # s, of the last observation
    last: Vec3  # (7,) newest usable inertial sample: time, accel, gyro
    x: Vec3  # (17,) `state_layout`
    P: Mat  # (6, 6) in tandem, (9, 9)
    A: Mat  # (3, 3) in tandem, (0, 0)
    centre: Vec3  # (6,) place (m) and velocity (m/s) of the centre of mass
    covariance: Mat  # (15, 15) of `NavState`
    heard: tuple[float, ...]  # s, newest measurement of each anchor, then of each target
    ranges: Acceptance
    frames: Acceptance
    rejected: int  # measurements in a row that failed the gate
    late: int  # measurements dropped because they came too late, or twice, in all
    track: Mat  # (n, 8) time, position (m), attitude, of the last observations
    distance: MeanDistance = MeanDistance()  # of measurements from what was expected


def begin(x: Vec3, P: Mat, A: Mat, lever: Vec3, sources: int) -> FlyerMemory:
    """Return the memory before the first observation.

    Args:
        x: (17,) state.
        P: covariance of what a range touches.
        A: covariance of the attitude in tandem, empty otherwise.
        lever: (3,), m, the radio on the body.
        sources: anchors and targets.
    """
    place, covariance = centre(x, P, A, lever)
    return FlyerMemory(
        now=0.0,
        last=np.array([-math.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        x=x,
        P=P,
        A=A,
        centre=place,
        covariance=covariance,
        heard=(-math.inf,) * sources,
        ranges=Acceptance(),
        frames=Acceptance(),
        rejected=0,
        late=0,
        track=np.empty((0, 8)),
    )
