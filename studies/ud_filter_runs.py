"""Kalman filters in single and double precision on the same numbers: factors, P - KHP, Joseph."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from missionkit.estimation.ud_filter import factors
from missionkit.geometry import Mat, Vec3

FEATURES, STATES = 6, 27  # position, velocity, bias of the accelerometer, features
DT = 0.05  # s
ACCELERATION, WALK = 0.05, 1e-3  # m/s²/√Hz, m/s²/√s
SEEN, RANGED = 0.01, 0.02  # m, standard deviations of a feature's place and of the height


class Step(NamedTuple):
    """What one step of the flight measures, and where the vehicle is."""

    acceleration: Vec3  # (3,), m/s², with bias and noise
    features: Mat  # (6, 3), m, from the vehicle
    height: float  # m, down
    position: Vec3  # (3,), m


def flight(seed: int, steps: int) -> list[Step]:
    """Return a flight over six features, 2 m up, at walking speed."""
    rng = np.random.default_rng(seed)
    features = rng.uniform((-5.0, -5.0, 0.0), (5.0, 5.0, 0.5), (FEATURES, 3))
    bias, position, velocity = 0.1 * rng.normal(size=3), np.array([0.0, 0.0, -2.0]), np.zeros(3)
    out = []
    for k in range(steps):
        push = 0.6 * np.array([np.sin(0.05 * k), np.cos(0.07 * k), 0.3 * np.sin(0.1 * k)])
        push -= 0.1 * velocity
        position = position + DT * velocity + 0.5 * DT * DT * push
        velocity = velocity + DT * push
        noise = ACCELERATION / np.sqrt(DT) * rng.normal(size=3)
        seen = features - position + SEEN * rng.normal(size=(FEATURES, 3))
        height = position[2] + RANGED * rng.normal()
        out.append(Step(push + bias + noise, seen, height, position))
    return out


class Model(NamedTuple):
    """The linear model of 27 states in one precision."""

    F: Mat
    B: Mat
    G: Mat
    q: Vec3
    P: Mat
    x: Vec3


def model(kind: type[np.floating], prior: float) -> Model:
    """Return it with features known to `prior` (m)."""
    one, F, B, G = np.eye(3), np.eye(STATES), np.zeros((STATES, 3)), np.zeros((STATES, 6))
    B[:3], B[3:6] = 0.5 * DT * DT * one, DT * one
    F[:3, 3:6], F[:, 6:9] = DT * one, F[:, 6:9] - B
    G[:, :3], G[6:9, 3:] = B, one
    q = np.repeat((ACCELERATION**2 / DT, WALK**2 * DT), 3)
    P = np.diag(np.repeat((1e-4, 1e-2, 1e-2, prior**2), (3, 3, 3, STATES - 9)))
    x = np.zeros(STATES)
    x[2] = -2.0
    return Model(*(np.ascontiguousarray(part, dtype=kind) for part in (F, B, G, q, P, x)))


def rows() -> Mat:
    """Return the Jacobian (19, 27): six places of three numbers, and the height."""
    H = np.zeros((3 * FEATURES + 1, STATES))
    for n in range(3 * FEATURES):
        H[n, 9 + n], H[n, n % 3] = 1.0, -1.0
    H[-1, 2] = 1.0
    return H


class Filter(NamedTuple):
    """A filter over two arrays: the factors, or the covariance and nothing."""

    begin: Callable[[Mat], tuple[Mat, Mat]]
    predict: Callable[[Mat, Mat, Mat, Mat, Vec3], None]
    update: Callable[[Vec3, Mat, Mat, Vec3, float, float], float]


def plain_predict(P: Mat, _: Mat, F: Mat, G: Mat, q: Vec3) -> None:
    """P := F P Fᵀ + G diag(q) Gᵀ."""
    P[:] = np.dot(np.dot(F, P), F.T) + np.dot(G * q, G.T)


def plain_update(x: Vec3, P: Mat, _: Mat, h: Vec3, residual: float, variance: float) -> float:
    """P := P - K h P."""
    Ph = (P * h).sum(axis=1)
    innovation = (h * Ph).sum() + variance
    K = Ph / innovation
    x += K * residual
    P -= K.reshape(-1, 1) * Ph
    return innovation


def joseph_update(x: Vec3, P: Mat, one: Mat, h: Vec3, residual: float, variance: float) -> float:
    """P := (I - K h) P (I - K h)ᵀ + K R Kᵀ."""
    Ph = (P * h).sum(axis=1)
    innovation = (h * Ph).sum() + variance
    K = Ph / innovation
    x += K * residual
    J = one - K.reshape(-1, 1) * h
    P[:] = np.dot(np.dot(J, P), J.T) + variance * K.reshape(-1, 1) * K
    return innovation


def _with_identity(P: Mat) -> tuple[Mat, Mat]:
    return P.copy(), np.eye(len(P), dtype=P.dtype)


FILTERS = {
    "U D Uᵀ": Filter(factors.factorised, factors.predict, factors.update),
    "P - KHP": Filter(_with_identity, plain_predict, plain_update),
    "Joseph": Filter(_with_identity, plain_predict, joseph_update),
}


def positions(how: Filter, kind: type[np.floating], steps: list[Step], prior: float = 100.0) -> Mat:
    """Return the estimated positions (n, 3), m, of one flight."""
    F, B, G, q, P, x = model(kind, prior)
    H, (one, other), out = rows().astype(kind), how.begin(P), []
    variances = np.repeat((SEEN**2, RANGED**2), (len(H) - 1, 1)).astype(kind)
    for step in steps:
        x = F @ x + B @ step.acceleration.astype(kind)
        how.predict(one, other, F, G, q)
        z = np.append(step.features.ravel(), step.height).astype(kind)
        for h, value, variance in zip(H, z, variances, strict=True):
            how.update(x, one, other, h, kind(value - h @ x), variance)
        out.append(x[:3].astype(float))
    return np.array(out)


def dyer_mcreynolds(how: Filter, delta: float) -> Mat:
    """Return the covariance (3, 3) that a filter in single precision comes to.

    P = I, h = (1, 1, 1) and then (1, 1, 1 + delta), each with noise of variance delta².

    Source: Grewal and Andrews, example 7.2, after P. Dyer and S. McReynolds, 1969.
    """
    one, other = how.begin(np.eye(3, dtype=np.float32))
    x, nothing = np.zeros(3, np.float32), np.float32(0.0)
    for h in nearly_alike(delta):
        how.update(x, one, other, h, nothing, np.float32(delta**2))
    P = one if how.begin is _with_identity else factors.covariance(one, other)
    return np.array(P, dtype=float)


def nearly_alike(delta: float) -> Mat:
    """Return the two rows (2, 3) of the Jacobian in single precision."""
    return np.array([[1.0, 1.0, 1.0], [1.0, 1.0, 1.0 + delta]], dtype=np.float32)


def exact_covariance(delta: float) -> Mat:
    """Return the same covariance by fractions, rounded once at the end."""
    P = [[Fraction(int(i == j)) for j in range(3)] for i in range(3)]
    R = Fraction(float(np.float32(delta**2)))
    for row in nearly_alike(delta).tolist():
        h = [Fraction(value) for value in row]
        Ph = [sum((a * b for a, b in zip(line, h, strict=True)), Fraction(0)) for line in P]
        S = sum((a * b for a, b in zip(h, Ph, strict=True)), R)
        P = [[P[i][j] - Ph[i] * Ph[j] / S for j in range(3)] for i in range(3)]
    return np.array([[float(value) for value in line] for line in P])
