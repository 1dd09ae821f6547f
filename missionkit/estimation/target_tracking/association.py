"""Which detection belongs to which track: gate by Z (P4 (19)), then global nearest neighbours."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from missionkit.estimation.target_tracking.model_bank import sound
from missionkit.estimation.target_tracking.multiple_models import BankState
from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled
from missionkit.messages import GroundDetection
from missionkit.messages.robot_modes import OBSTACLE

MOST_DETECTIONS = 20
"""Raw detections of one frame that are looked at, those with the highest scores (P4 III-A)."""
FORBIDDEN = 1e6
"""Cost of a pair outside the gate: more than any number of pairs inside can make up for."""


def usable(detections: Sequence[GroundDetection]) -> list[GroundDetection]:
    """Return the detections that are sound, the surest first, at most `MOST_DETECTIONS`."""
    found = [it for it in detections if _is_sound(it)]
    return sorted(found, key=lambda it: -it.score)[:MOST_DETECTIONS]


def fused(detections: Sequence[GroundDetection], reach: float) -> list[GroundDetection]:
    """Return one detection of each object that several detectors found.

    Detections by different detectors, or of different kinds, nearer than `reach` to each other are
    one: its place is that of covariance intersection, since both come from the same pixels, and its
    score that of one of the two being right, 1 - (1 - a)(1 - b). One that is an obstacle robot to
    either is one. What the vehicle's pose is off by shifts all detections of a frame alike, so the
    distance is in metres.

    Args:
        detections: sound, the surest first.
        reach: m, half a robot.
    """
    objects: list[tuple[GroundDetection, frozenset[tuple[str, str]]]] = []
    for it in detections:
        near = [
            (math.dist(it.position, other.position), i)
            for i, (other, by) in enumerate(objects)
            if (it.detector, it.kind) not in by
        ]
        distance, i = min(near, default=(math.inf, -1))
        if distance < reach:
            other, by = objects[i]
            objects[i] = _intersection(other, it), by | {(it.detector, it.kind)}
        else:
            objects.append((it, frozenset({(it.detector, it.kind)})))
    return [it for it, _ in objects]


def assigned(
    tracks: Sequence[BankState], detections: Sequence[GroundDetection], gate: float
) -> dict[int, int]:
    """Return which track, by its index, gets which detection.

    As many tracks as possible get one within the gate; among those ways the one with the largest
    product of likelihoods is taken. A greedy nearest neighbour swaps two targets that cross.
    A detection is within the gate of a track if it is within that of one of its models: a spin
    that has just begun is expected by the model of spins alone.

    Args:
        tracks: their filters, at the time of the frame.
        detections: of one frame.
        gate: largest Z, a squared Mahalanobis distance.
    """
    if not tracks or not detections:
        return {}
    from scipy.optimize import linear_sum_assignment  # noqa: PLC0415 heavy

    z = np.array([it.position for it in detections])
    R = np.array([it.covariance for it in detections])
    Z, costs = np.empty((2, len(tracks), len(detections)))
    for i, it in enumerate(tracks):
        _fits(it.X, it.P, it.mu, z, R, Z[i], costs[i])
    costs[gate < Z] = FORBIDDEN
    pairs = zip(*linear_sum_assignment(costs), strict=True)
    return {int(i): int(j) for i, j in pairs if Z[i, j] <= gate}


@compiled
def _fits(X: Mat, P: Mat, mu: Vec3, z: Mat, R: Mat, nearest: Vec3, costs: Vec3) -> None:
    """Write each detection's least Z over the models, and -2 ln Σ_j μ_j p(z | model j) but for 2π.

    Args:
        X: (k, 3) states of the models.
        P: (k, 3, 3) covariances.
        mu: (k,) probabilities.
        z: (m, 2) places.
        R: (m, 2, 2) their covariances.
        nearest: (m,), to be written.
        costs: (m,), to be written.
    """
    for j in range(len(z)):
        nearest[j], likelihood = math.inf, 0.0
        for i in range(len(X)):
            a, b = P[i, 0, 0] + R[j, 0, 0], P[i, 0, 1] + R[j, 0, 1]
            d = P[i, 1, 1] + R[j, 1, 1]
            det = a * d - b * b
            r, s = z[j, 0] - X[i, 0], z[j, 1] - X[i, 1]
            Z = (d * r * r - 2.0 * b * r * s + a * s * s) / det
            nearest[j] = min(nearest[j], Z)
            likelihood += mu[i] * math.exp(-0.5 * min(Z, 1000.0)) / math.sqrt(det)
        costs[j] = -2.0 * math.log(max(likelihood, 1e-300))


def _is_sound(it: GroundDetection) -> bool:
    numbers = (it.score, it.size, it.offset, it.height)
    fits = np.shape(it.position) == (2,) and np.shape(it.covariance) == (2, 2)
    if not (fits and all(math.isfinite(n) for n in numbers)):
        return False
    return sound(it.position, it.covariance) and 0.0 <= it.score <= 1.0 and it.size > 0.0


def _intersection(a: GroundDetection, b: GroundDetection) -> GroundDetection:
    """Return one detection of two of the same object, at most as certain as the better of them."""
    A, B = np.linalg.inv(a.covariance), np.linalg.inv(b.covariance)
    covariance: Mat = np.linalg.inv(0.5 * (A + B)).astype(np.float64)
    sized = [it.size for it in (a, b) if it.sized] or [a.size, b.size]
    return a._replace(
        position=covariance @ (0.5 * (A @ a.position + B @ b.position)),
        covariance=covariance,
        score=1.0 - (1.0 - a.score) * (1.0 - b.score),
        size=sum(sized) / len(sized),
        sized=a.sized or b.sized,
        kind=OBSTACLE if OBSTACLE in {a.kind, b.kind} else a.kind,
    )
