"""The first heading of a target: a line through the places where it was measured lately."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Mat, Vec3

LEAST_PLACES = 6
MOST_PLACES = 12
SHARE_OF_SPEED = 0.75
"""A line slower than this share of the speed is that of a target that spins meanwhile."""
LEAST_CERTAIN = math.radians(15.0)


class Place(NamedTuple):
    """One measured place."""

    at: float  # s
    z: Vec3  # (2,), m
    R: Mat  # (2, 2), m²


def first_state(places: Sequence[Place], speed: float) -> tuple[Vec3, Mat] | None:
    """Return position and heading (3,) with covariance (3, 3) at the last place, None: not yet.

    A least-squares line through the last places, each axis alone; the heading is that of its
    velocity, with the deviation that the velocity's noise gives it.

    Args:
        places: in the order of time.
        speed: m/s, of the target when it drives.
    """
    last = places[-MOST_PLACES:]
    if len(last) < LEAST_PLACES:
        return None
    ages = np.array([it.at - last[-1].at for it in last])
    A = np.column_stack((np.ones(len(last)), ages))
    noise = sum(float(np.trace(it.R)) for it in last) / (2.0 * len(last))
    (north, vn), (east, ve) = np.linalg.lstsq(A, np.array([it.z for it in last]))[0].T
    covariance = noise * np.linalg.inv(A.T @ A)
    pace = math.hypot(vn, ve)
    if pace < SHARE_OF_SPEED * speed or math.sqrt(covariance[1, 1]) > LEAST_CERTAIN * pace:
        return None
    heading_variance = covariance[1, 1] / pace**2
    P = np.diag([covariance[0, 0], covariance[0, 0], max(heading_variance, math.radians(4.0) ** 2)])
    return np.array([north, east, math.atan2(ve, vn)]), P
