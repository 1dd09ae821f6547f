"""Several models of motion at once, each with a filter and a probability; compiled.

The models are mutually exclusive: μ_j is the probability that the target moves by model j now.
An interacting bank (IMM) lets it change from one model to another: before each step every filter
begins from a mixture of all. In a bank without interaction (MMAE) the filters know nothing of each
other, and the probabilities are kept within [0.01, 0.99].

    mixing      c_j = Σ_i M_ij μ_i,   x_0j = Σ_i M_ij μ_i x_i / c_j,   and P_0j with the spread
    evidence    μ_j := c_j p(z | model j) / Σ_j c_j p(z | model j)     (P4 (21), (22))

Headings are mixed on the side of the circle where the likeliest model's is.

Source: Y. Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with Applications to Tracking and
Navigation", 2001, section 11.6.6; P4 section III-B for the MMAE. filterpy's IMMEstimator and
MMAEFilterBank are the same equations: `filterpy_bank`.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.linear_algebra import wrap
from missionkit.estimation.target_tracking import motion_models
from missionkit.estimation.target_tracking.motion_models import HEADING
from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled

LARGEST = 1e6
"""No input is larger than this, in SI units."""

_predict = motion_models.predict
_update = motion_models.update


@compiled
def switching(rates: Mat, dt: float) -> Mat:
    """Return the probabilities M (n, n) of a change from model i to model j within `dt`.

    Args:
        rates: (n, n), 1/s, of changes from i to j; the diagonal does not matter.
        dt: s.
    """
    n = len(rates)
    M = np.zeros((n, n))
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += rates[i, j] if j != i else 0.0
        for j in range(n):
            if j != i and total > 0.0:
                M[i, j] = -math.expm1(-total * dt) * rates[i, j] / total
        M[i, i] = math.exp(-total * dt)
    return M


@compiled
def predict(X: Mat, P: Mat, models: Mat, dt: float) -> None:
    """Carry every filter on by `dt`, each alone, in place.

    Args:
        X: (n, 3) states.
        P: (n, 3, 3) covariances.
        models: (n, 4), `motion_models.table`.
        dt: s.
    """
    for j in range(len(X)):
        _predict(X[j], P[j], models[j], dt)


@compiled
def interact(X: Mat, P: Mat, mu: Vec3, models: Mat, M: Mat, dt: float) -> None:
    """Let every filter begin from a mixture of all and carry it on by `dt`, in place; μ becomes c.

    Args:
        X: (n, 3) states.
        P: (n, 3, 3) covariances.
        mu: (n,) probabilities.
        models: (n, 4), `motion_models.table`.
        M: (n, n) probabilities of a change from i to j within `dt`.
        dt: s.
    """
    n = len(X)
    unwrap(X, mu)
    old_X, old_P, old_mu = X.copy(), P.copy(), mu.copy()
    for j in range(n):
        c = 0.0
        for i in range(n):
            c += M[i, j] * old_mu[i]
        mu[j] = c
        if c > 0.0:
            _mixture(X[j], P[j], old_X, old_P, M[:, j] * old_mu / c)
    predict(X, P, models, dt)


@compiled
def update(X: Mat, P: Mat, mu: Vec3, z: Vec3, R: Mat, least: float) -> bool:
    """Take in a place z on the ground: every filter, then the probabilities, in place.

    Says whether it was done: what is not finite, or has no covariance, changes nothing.

    Args:
        X: (n, 3) states.
        P: (n, 3, 3) covariances.
        mu: (n,) probabilities.
        z: (2,), m, north and east.
        R: (2, 2) covariance of z, m².
        least: no probability becomes less.
    """
    if not sound(z, R):
        return False
    n = len(X)
    logs = np.empty(n)
    for j in range(n):
        logs[j] = _update(X[j], P[j], z, R)
    weigh(mu, logs, least)
    return True


@compiled
def weigh(mu: Vec3, logs: Vec3, least: float) -> None:
    """Multiply probabilities by likelihoods, and norm them, in place.

    Args:
        mu: (n,) probabilities.
        logs: (n,) logarithms of the likelihoods.
        least: no probability becomes less.
    """
    largest, total = logs.max(), 0.0
    for j in range(len(mu)):
        mu[j] *= math.exp(logs[j] - largest)
        total += mu[j]
    if total > 0.0:
        mu /= total
    else:  # the models that explain it were impossible
        mu[:] = 1.0 / len(mu)
    limit(mu, least)


@compiled
def limit(mu: Vec3, least: float) -> None:
    """Keep probabilities within [least, 1 - least] and norm them again, in place (P4, (23))."""
    if least > 0.0 and len(mu) > 1:
        for j in range(len(mu)):
            mu[j] = min(max(mu[j], least), 1.0 - least)
        mu /= mu.sum()


@compiled
def combined(X: Mat, P: Mat, mu: Vec3) -> tuple[Vec3, Mat]:
    """Return mean (3,) and covariance (3, 3) over all models; the heading's is the circular mean.

    Args:
        X: (n, 3) states.
        P: (n, 3, 3) covariances.
        mu: (n,) probabilities.
    """
    s = c = 0.0
    for j in range(len(X)):
        s += mu[j] * math.sin(X[j, HEADING])
        c += mu[j] * math.cos(X[j, HEADING])
    heading = math.atan2(s, c)
    near = X.copy()
    for j in range(len(X)):
        near[j, HEADING] = heading + wrap(X[j, HEADING] - heading)
    x, S = np.empty(3), np.empty((3, 3))
    _mixture(x, S, near, P, mu)
    x[HEADING] = heading
    return x, S


@compiled
def sound(z: Vec3, R: Mat) -> bool:
    """Say whether a place (2,) with its covariance (2, 2) is a measurement."""
    if not (abs(z[0]) < LARGEST and abs(z[1]) < LARGEST and 0.0 < R[0, 0] < LARGEST):
        return False
    return bool(0.0 < R[0, 0] * R[1, 1] - R[0, 1] * R[1, 0] < LARGEST)


@compiled
def unwrap(X: Mat, mu: Vec3) -> None:
    """Bring all headings within half a turn of the likeliest model's, in place."""
    at = X[np.argmax(mu), HEADING]
    for j in range(len(X)):
        X[j, HEADING] = at + wrap(X[j, HEADING] - at)


@compiled
def _mixture(x: Vec3, S: Mat, X: Mat, P: Mat, w: Vec3) -> None:
    """Write mean and covariance of a mixture into x (3,) and S (3, 3)."""
    x[:] = 0.0
    for i in range(len(X)):
        x += w[i] * X[i]
    S[:] = 0.0
    for i in range(len(X)):
        for a in range(3):
            for b in range(3):
                S[a, b] += w[i] * (P[i, a, b] + (X[i, a] - x[a]) * (X[i, b] - x[b]))
