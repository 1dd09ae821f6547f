"""Compiling the filter's kernels, or loading them from their cache, before a flight needs them."""

from __future__ import annotations

from functools import cache

import numpy as np

from missionkit.estimation.error_state_ekf.filter import ErrorStateEkf
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.geometry import GRAVITY, Transform, vec
from missionkit.messages import (
    Baro,
    Detection,
    Gnss,
    Imu,
    Magnetometer,
    Observation,
    Sighting,
)


@cache
def warm_up() -> None:
    """Let a filter at rest align and take in a measurement of every kind.

    A few milliseconds, or as many seconds as compiling takes; a tick has less time than that.
    """
    still = vec(0.0, 0.0, 0.0)
    here = Transform(np.array([1.0, 0.0, 0.0, 0.0]), still)
    navigator = ErrorStateEkf(VisualInertialEkf(align_for=0.02), {"target": (still, 1.0)}, here)
    known = navigator.begin()
    for now in (0.05, 0.1):
        seen = Observation(
            now,
            imu=tuple(Imu(now + part, vec(0.0, 0.0, -GRAVITY), still) for part in (-0.02, 0.0)),
            gnss=Gnss(now, still, still, np.ones(3), 1.0),
            baro=Baro(now, 0.0),
            mag=Magnetometer(now, vec(1.0, 0.0, 0.0)),
        )
        known = navigator.propagate(known, seen)
    for at in (0.09, 0.1):
        marker = Detection("", 0, np.zeros((4, 2)), 0.0)
        sighting = Sighting(at, "target", 0, here, 1.0, 1.0, 0.0, ambiguous=False, detection=marker)
        known = navigator.fuse(known, (sighting,))
    navigator.read(known)
