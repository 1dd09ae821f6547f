"""How well ranges place a free flyer in the long run, and what Algorithm 1 makes of it (P3, V-D).

All places are in the mother-ship's frame (m). Anchors are heard in turn, `rate` ranges a second in
all, so that a place p is measured at the information rate

    M = rate / (N σ_r²) Σ u_i u_iᵀ,   u_i = (p - a_i) / |p - a_i|       (1/(m² s))

White acceleration of density q (m²/s³) on every axis leaves the continuous Riccati equation of
place and velocity to the eigenvectors of M, one double integrator each:

    P_pp = √2 q^¼ m^-¾,   m an eigenvalue of M

Source: P3 section V-D; Gelb, "Applied Optimal Estimation", example 4.6-1 (the double integrator).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.interpolate import RegularGridInterpolator
from scipy.stats import norm as normal

from missionkit.geometry import Mat, Vec3

RANGE_SD, RANGE_RATE = 0.02, 50.0  # m, 1/s
ACCEL_NOISE = 0.0071  # m/s²/√Hz, as in the study of the docking
ACTIVATION, DOCKED = 1.0, 0.1  # r_t, r_d, m
LEAVE_APPROACH, LEAVE_REORIENT = 0.4, 0.6
DISTANCE = 0.82  # d of a consistent filter
HALF_ANGLE = math.radians(35.0)  # of the camera
EDGES = ((-1.2, 1.2, 25), (0.3, 2.3, 21), (-0.8, 1.2, 21))  # m, m, points of the grid
STEPS = 200  # of the way

Layout = Sequence[tuple[float, float, float]]


def covariances(places: Mat, anchors: Mat) -> Mat:
    """Return the steady-state covariance (N, 3, 3), m², of each place (N, 3).

    Args:
        places: of the radio.
        anchors: (A, 3) that are heard.
    """
    away = places[:, None, :] - anchors[None, :, :]
    unit = away / np.linalg.norm(away, axis=2, keepdims=True)
    share = RANGE_RATE / (len(anchors) * RANGE_SD**2)
    m, axes = np.linalg.eigh(share * np.einsum("nai,naj->nij", unit, unit))
    variance = math.sqrt(2.0) * math.sqrt(ACCEL_NOISE) * np.maximum(m, 1e-9) ** -0.75
    return np.einsum("nik,nk,njk->nij", axes, variance, axes)


def largest_sd(places: Mat, anchors: Mat) -> Mat:
    """Return the greatest standard deviation (N,), m, of an axis of the mother-ship's."""
    return np.sqrt(np.diagonal(covariances(places, anchors), axis1=1, axis2=2).max(axis=1))


def worst_sd(places: Mat, anchors: Mat) -> Mat:
    """Return the same (N,) without the anchor that is missed most at each place."""
    fewer = [np.delete(anchors, n, axis=0) for n in range(len(anchors))]
    return np.asarray(np.max([largest_sd(places, kept) for kept in fewer], axis=0))


class Grid(NamedTuple):
    """Largest standard deviations (m) by place, of a layout."""

    best: RegularGridInterpolator  # all anchors are heard
    worst: RegularGridInterpolator  # without the one that is missed most there


def grid_of(layout: Layout) -> Grid:
    """Return the grid of a layout; worst: without the anchor that is missed most at each place."""
    anchors = np.array(layout, dtype=float)
    axes = [np.linspace(*edge) for edge in EDGES]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    shape = tuple(len(axis) for axis in axes)
    sds = largest_sd(places, anchors), worst_sd(places, anchors)
    return Grid(*(RegularGridInterpolator(axes, sd.reshape(shape)) for sd in sds))


class Outlook(NamedTuple):
    """What Algorithm 1 would do from a start pose."""

    sd: float  # m, largest, where it ends up aligning
    probability: float  # π of align there
    r2: float  # m
    r1: float  # m
    in_view: float  # probability that the camera, turned as it will dock, sees the target there


def outlook(
    sds: RegularGridInterpolator, place: Vec3, q: float, target: Vec3, axis: Vec3
) -> Outlook:
    """Return how Algorithm 1 switches on the straight way from a place to the target.

    Args:
        sds: largest standard deviation by place.
        place: (3,), m, start.
        q: |q_e|, vector part of the attitude error at the start.
        target: (3,), m, centre.
        axis: (3,), unit, out of the docking face.
    """
    away = place - target
    far = math.sqrt(float(away @ away))
    line = away / far
    r2 = min(far, ACTIVATION, LEAVE_APPROACH * ACTIVATION * (1.0 + DISTANCE) * q)
    r2 = max(r2, DOCKED + 1e-3)
    r = np.linspace(r2, DOCKED, STEPS)
    sd = sds(target + r[:, None] * line)
    a23 = 1.0 - np.minimum(1.0, r / r2 / (1.0 + DISTANCE))
    a32 = np.clip(sd / RANGE_SD * (r2 - r) / (r2 - DOCKED), 0.0, 1.0)
    pi = a23 / (a23 + a32)
    below = np.flatnonzero(pi <= LEAVE_REORIENT)
    at = int(below[0]) if len(below) else STEPS - 1
    off = math.acos(min(1.0, max(-1.0, float(line @ axis))))
    view = normal.cdf((HALF_ANGLE - off) * float(r[at]) / float(sd[at]))
    return Outlook(float(sd[at]), float(pi[at]), r2, float(r[at]), float(view))
