"""Khatib's artificial potential field, as P1 section 4 has it.

    U_att(p) = k/2 |p - goal|²
    U_rep(p) = Σ_i w_i H(r - d_i) (1/d_i - 1/r)²,   d_i = |p - p_i| - body

    v_att = -∇U_att = k (goal - p)
    v_rep = -½ diag(η_xy, η_xy, η_z) ∇U_rep
          = + Σ_i w_i diag(η) H(r - d_i) (1/d_i - 1/r) (1/d_i²) (p - p_i) / |p - p_i|

P1's sign is corrected (it attracts as printed) and the 2 of the derivative is folded into η
(correction P1.1). With `body` = 0 this is P1's (1/d - 1/r)(1/d³)(p - p_i); otherwise d is measured
to the vehicle's surface. P1's η_i of an obstacle is w_i η. η
multiplies each axis, so only an isotropic η is a gradient field.

Source: O. Khatib, "Real-time obstacle avoidance for manipulators and mobile robots", 1986.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from missionkit.geometry import Vec3
from missionkit.messages import Points

LEAST_DISTANCE = 0.05  # m; distances are not taken to be shorter, since v_rep grows without bound

Distances = npt.NDArray[np.float64]  # (N,), m
Weights = npt.NDArray[np.float64] | float  # (N,), 1


def attractive_potential(p: Vec3, goal: Vec3, k: float) -> float:
    """Return U_att at `p`; p and goal (3,), m; k in 1/s.

    Args:
        p: (3,), m, the vehicle.
        goal: (3,), m, in the frame of `p`.
        k: gain, 1/s.

    Returns:
        m²/s.
    """
    gap = p - goal
    return 0.5 * k * float(gap @ gap)


def attraction(p: Vec3, goal: Vec3, k: float) -> Vec3:
    """Return v_att (3,), m/s, towards `goal`.

    Args:
        p: (3,), m, the vehicle.
        goal: (3,), m, in the frame of `p`.
        k: gain, 1/s.
    """
    return k * (goal - p)


def repulsive_potential(
    p: Vec3, points: Points, radius: float, body: float = 0.0, weights: Weights = 1.0
) -> float:
    """Return U_rep at `p` for unit gain, summed over the points (N, 3), m, within `radius`.

    Args:
        p: (3,), m, the vehicle.
        points: (N, 3), m, obstacles.
        radius: influence radius r, m, from the surface of the vehicle.
        body: radius of the vehicle, m.
        weights: (N,), of the points.

    Returns:
        1/m².
    """
    distance = np.maximum(np.linalg.norm(p - points, axis=1) - body, LEAST_DISTANCE)
    closeness = np.maximum(1.0 / distance - 1.0 / radius, 0.0)
    return float(np.sum(weights * closeness**2))


def strengths(surface: Distances, radius: float) -> Distances:
    """Return H(r - d)(1/d - 1/r)(1/d²), (N,), 1/m³, at distances d (N,), m, from the surface."""
    closeness = 1.0 / np.maximum(surface, LEAST_DISTANCE)
    return np.maximum(closeness - 1.0 / radius, 0.0) * closeness * closeness


def repulsion(
    p: Vec3,
    points: Points,
    radius: float,
    gain: Vec3,
    body: float = 0.0,
    weights: Weights = 1.0,
) -> Vec3:
    """Return v_rep (3,), m/s, as P1 sums it over all points.

    Args:
        p: (3,), m, the vehicle.
        points: (N, 3), m, obstacles.
        radius: influence radius r (m).
        gain: (3,) diagonal of η (m⁴/s).
        body: radius of the vehicle (m).
        weights: (N,), of the points.
    """
    away = p - points
    distance = np.maximum(np.linalg.norm(away, axis=1), LEAST_DISTANCE)
    total: Vec3 = gain * ((weights * strengths(distance - body, radius) / distance) @ away)
    return total


def mean_repulsion(
    away: Points,
    distance: Distances,
    radius: float,
    gain: Vec3,
    body: float,
    weights: Weights = 1.0,
) -> Vec3:
    """Return v_rep (3,), m/s, as the mean over all points, weighted by strength.

    A scan sees one surface as many points, so P1's sum grows with the resolution of the sensor.
    With s_i the strength of point i times its weight and n_i the direction from it, here

        v_rep = diag(η) max(s) Σ s_i n_i / Σ s_i.

    For one point this is P1's; equal pushes from opposite sides still cancel.

    Args:
        away: (N, 3), m, from each point to the vehicle.
        distance: (N,), m, lengths of `away`.
        radius: influence radius r (m).
        gain: (3,) diagonal of η (m⁴/s).
        body: radius of the vehicle (m).
        weights: (N,), of the points.
    """
    strength = weights * strengths(distance - body, radius)
    strongest = strength[strength.argmax()]
    if strongest == 0.0:
        return np.zeros(3)
    share = strength / np.maximum(distance, LEAST_DISTANCE)
    mean: Vec3 = gain * (share @ away) * (strongest / strength.sum())
    return mean
