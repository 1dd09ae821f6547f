"""From optical flow to velocity over ground: rate, height and tilt compensation; compiled."""

from __future__ import annotations

import numpy as np

from missionkit.estimation.linear_algebra import to_matrix
from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled

LEAST_USEFUL_COSINE = 0.5
"""Tilted further than 60 deg, the axis does not meet the ground in any useful place."""


@compiled
def across(flow: Vec3, rates: Vec3, distance: float) -> Mat:
    """Return the velocity (2,) along the body's x and y, m/s.

    A point of the ground on the sensor's axis, z down in the body, is at (0, 0, d) and moves by
    -v - ω × p. Its image (ẋ, ẏ) = flow gives v_x = -d (ẋ + ω_y), v_y = -d (ẏ - ω_x).

    Args:
        flow: (2,), rad/s.
        rates: (3,), rad/s, FRD.
        distance: d, along the axis (m).
    """
    return np.array((-distance * (flow[0] + rates[1]), -distance * (flow[1] - rates[0])))


@compiled
def over_ground(flow: Vec3, rates: Vec3, height: float, q: Vec3, climb: float, out: Vec3) -> bool:
    """Write the velocity north and east (2,), m/s, into `out`; say whether it is known.

    Flow says nothing of motion along its axis: the climb does. d = h / R_33, and v_z follows from
    R_31 v_x + R_32 v_y + R_33 v_z = -climb.

    Args:
        flow: (2,), rad/s.
        rates: (3,), rad/s, FRD, without bias.
        height: above the ground (m).
        q: (4,), body to world.
        climb: m/s, up.
        out: (2,).
    """
    R = to_matrix(q)
    if R[2, 2] < LEAST_USEFUL_COSINE or not height > 0.0:
        return False
    v = across(flow, rates, height / R[2, 2])
    along = (-climb - R[2, 0] * v[0] - R[2, 1] * v[1]) / R[2, 2]
    for i in range(2):
        out[i] = R[i, 0] * v[0] + R[i, 1] * v[1] + R[i, 2] * along
    return bool(abs(out[0]) < 1e3 and abs(out[1]) < 1e3)
