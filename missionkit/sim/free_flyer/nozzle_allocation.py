"""Which nozzles exert a wrench: a linear program solved by its vertices, and a pseudo-inverse.

    minimise Σ f_i   so that   B f = w,  f >= 0        B (6, N): force and torque of unit thrusts

A vertex has six nozzles. By the duality theorem a vertex is optimal for w if its thrusts are not
negative and its prices y = B_k⁻ᵀ 1 satisfy Bᵀ y <= 1, which does not depend on w: the few vertices
that satisfy it are found once, and a wrench takes the first of them whose thrusts are all >= 0.
Source: Bertsimas and Tsitsiklis, "Introduction to Linear Optimization", 1997, sections 4.3 and 5.2.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math
from functools import cache
from itertools import combinations
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled
from missionkit.sim.free_flyer.body_model import FreeFlyerBody

NOZZLES = 10
VERTEX_SLACK = 1e-9


class Vertices(NamedTuple):
    """The vertices that can be optimal, each with its six nozzles."""

    nozzles: npt.NDArray[np.intp]  # (K, 6)
    inverses: Mat  # (K, 6, 6), wrench to their thrusts


def nozzle_matrix(size: float, arm: float) -> Mat:
    """Return force and torque of unit thrusts, (6, 10), body axes: N, N·m for each N.

    Nozzles 0 to 4 are on the front, 5 to 9 on the back; the first of each is in the middle.

    Args:
        size: side of the cube (m).
        arm: of the corner nozzles, from the middle along each edge (m).
    """
    columns = []
    for side in (1.0, -1.0):
        columns.append(_column((side * size / 2.0, 0.0, 0.0), (-side, 0.0, 0.0)))
        for corner in range(4):
            angle = math.radians(45.0 + 90.0 * corner)
            spin = 1.0 if corner % 2 == 0 else -1.0
            out = math.sqrt(2.0) * arm
            place = (side * size / 2.0, out * math.cos(angle), out * math.sin(angle))
            columns.append(_column(place, (0.0, -spin * math.sin(angle), spin * math.cos(angle))))
    return np.array(columns).T


def _column(place: tuple[float, float, float], push: tuple[float, float, float]) -> Mat:
    return np.concatenate((push, np.cross(place, push)))


@cache
def vertices(size: float, arm: float) -> Vertices:
    """Return the vertices that can be optimal for a cube's nozzles."""
    matrix = nozzle_matrix(size, arm)
    found, inverses = [], []
    for chosen in combinations(range(NOZZLES), 6):
        basis = matrix[:, chosen]
        if np.linalg.cond(basis) > 1e9:
            continue
        inverse = np.linalg.inv(basis)
        if np.all(matrix.T @ (inverse.T @ np.ones(6)) <= 1.0 + VERTEX_SLACK):
            found.append(chosen)
            inverses.append(inverse)
    return Vertices(np.array(found), np.array(inverses))


@compiled
def least_thrusts(of: Vertices, wrench: Vec3) -> Mat:
    """Return the thrusts (10,), N, of least sum that exert a wrench (6,)."""
    best, chosen = -math.inf, 0
    for k in range(of.nozzles.shape[0]):
        least = math.inf
        for row in range(6):
            push = 0.0
            for c in range(6):
                push += of.inverses[k, row, c] * wrench[c]
            least = min(least, push)
        if least > best:
            best, chosen = least, k
        if best >= 0.0:
            break
    out = np.zeros(NOZZLES)
    for row in range(6):
        push = 0.0
        for c in range(6):
            push += of.inverses[chosen, row, c] * wrench[c]
        out[of.nozzles[chosen, row]] = max(0.0, push)
    return out


@cache
def _pseudo_inverse(size: float, arm: float) -> Mat:
    inverse: Mat = np.asarray(np.linalg.pinv(nozzle_matrix(size, arm)), dtype=np.float64)
    return inverse


def clipped_thrusts(size: float, arm: float, wrench: Vec3) -> Mat:
    """Return the thrusts (10,), N, of the pseudo-inverse, raised until none is negative.

    f = B⁺ w + λ 1 with the least λ >= 0, since all nozzles together exert nothing.

    Args:
        size: edge of the cube, m.
        arm: of the corner nozzles, from the middle along each edge, m.
        wrench: (6,), force (N) and torque (N·m), body.
    """
    thrusts: Mat = _pseudo_inverse(size, arm) @ wrench
    return thrusts + max(0.0, -float(thrusts.min()))


def thrusts_for(body: FreeFlyerBody, force: Vec3, torque: Vec3) -> Mat:
    """Return the thrust (10,), N, that each nozzle is to give.

    Each axis is clipped to its limit first. A nozzle that cannot give enough makes all of them
    give less, so that the wrench keeps its direction.

    Args:
        body: its nozzles and limits.
        force: (3,), N, body axes.
        torque: (3,), N·m, body axes.
    """
    wrench = np.array([*_clipped(force, body.force), *_clipped(torque, body.torque)])
    if body.allocation == "linear_program":
        thrusts = least_thrusts(vertices(body.size, body.nozzle_arm), wrench)
    else:
        thrusts = clipped_thrusts(body.size, body.nozzle_arm, wrench)
    most = float(thrusts.max())
    return thrusts * (body.nozzle_thrust / most) if most > body.nozzle_thrust else thrusts


def _clipped(v: Vec3, limit: float) -> list[float]:
    return [max(-limit, min(limit, c)) for c in v.tolist()]
