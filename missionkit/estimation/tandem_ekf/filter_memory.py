"""Memory of the free flyer's navigator between observations."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.estimation.tandem_ekf.acceptance import Acceptance
from missionkit.geometry import Mat, Vec3


class FlyerMemory(NamedTuple):
    """All the navigator knows; an immutable value."""

    now: float  # s, of the last observation
    last: Vec3  # (7,) newest usable inertial sample: time, accel, gyro
    x: Vec3  # (17,) `state_layout`
    P: Mat  # (6, 6) in tandem, (9, 9)
    A: Mat  # (3, 3) in tandem, (0, 0)
    heard: tuple[float, ...]  # s, newest measurement of each anchor, then of each target
    ranges: Acceptance
    frames: Acceptance
    rejected: int  # measurements in a row that failed the gate
    late: int  # measurements dropped because they came too late, or twice, in all
    track: Mat  # (n, 8) time, position (m), attitude, of the last observations


def begin(x: Vec3, P: Mat, A: Mat, sources: int) -> FlyerMemory:
    """Return the memory before the first observation.

    Args:
        x: (17,) state.
        P: covariance of what a range touches.
        A: covariance of the attitude in tandem, empty otherwise.
        sources: anchors and targets.
    """
    return FlyerMemory(
        now=0.0,
        last=np.array([-math.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        x=x,
        P=P,
        A=A,
        heard=(-math.inf,) * sources,
        ranges=Acceptance(),
        frames=Acceptance(),
        rejected=0,
        late=0,
        track=np.empty((0, 8)),
    )
