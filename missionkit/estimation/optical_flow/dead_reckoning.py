"""Dead reckoning by the flow sensor alone: what fusion is compared with.

The sensor's own gyroscope takes turns out of the flow, its own range finder gives the scale, and
the heading is what it was at the start; nothing filters.  Source: P2 section VI, "stand alone
optical flow sensor".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.estimation.optical_flow.flow_velocity import across
from missionkit.geometry import Vec3
from missionkit.messages import Observation


class Reckoning(NamedTuple):
    """Where flow alone has led; an immutable value."""

    position: Vec3  # (2,), m, north and east
    velocity: Vec3  # (2,), m/s, of the last good sample
    heading: float  # rad
    at: float | None = None  # s, end of the last good sample
    distance: float | None = None  # m, last received


def begin(position: Vec3, heading: float) -> Reckoning:
    """Return a start at a place (2,), m, north and east."""
    return Reckoning(position.copy(), np.zeros(2), heading)


def reckoned(known: Reckoning, seen: Observation, quality: float = 0.3) -> Reckoning:
    """Return the reckoning with one more observation.

    x += R(ψ) v (t - t_last), so that a good sample also stands for the hole before it.

    Args:
        known: the reckoning so far.
        seen: flow, range and attitude.
        quality: share below which flow is not used.
    """
    if seen.range is not None:
        known = known._replace(distance=seen.range.distance)
    flow = seen.flow
    if flow is None or flow.rates is None or known.distance is None or flow.quality < quality:
        return known
    v = across(flow.flow, flow.rates, known.distance)
    if not np.isfinite(v).all():
        return known
    cos, sin = math.cos(known.heading), math.sin(known.heading)
    velocity = np.array([cos * v[0] - sin * v[1], sin * v[0] + cos * v[1]])
    over = flow.over if known.at is None else flow.at - known.at
    return known._replace(position=known.position + over * velocity, velocity=velocity, at=flow.at)
