"""The bank of models by filterpy: the choice `library: filterpy` of a tracker.

The equations, arguments and answers of `model_bank`, whose kernels are the default and fifty times
as fast. IMMEstimator mixes and predicts, MMAEFilterBank weighs the models by their likelihoods.
filterpy propagates a NaN silently: what goes in is checked before, and what comes out counts only
if all of it is finite.
"""

from __future__ import annotations

import numpy as np
from filterpy.kalman import IMMEstimator, KalmanFilter, MMAEFilterBank

from missionkit.estimation.target_tracking import motion_models
from missionkit.estimation.target_tracking.model_bank import limit, sound, unwrap
from missionkit.geometry import Mat, Vec3


class _ModelFilter(KalmanFilter):  # type: ignore[misc]  # filterpy has no types
    """filterpy's filter with the motion of one model."""

    def __init__(self, x: Vec3, P: Mat, model: Vec3, dt: float) -> None:
        super().__init__(dim_x=3, dim_z=2)
        self.x, self.P, self.H = x.copy(), P.copy(), np.eye(2, 3)
        self._model, self._dt = model, dt

    def predict(self, u: object = None) -> None:  # noqa: ARG002  as filterpy calls it
        """Move along the model's arc."""
        self.F = motion_models.jacobian(self.x, self._model, self._dt)
        self.Q = motion_models.process_noise(self.x, self._model, self._dt)
        after = motion_models.moved(self.x, self._model, self._dt)
        super().predict()
        self.x = after


def predict(X: Mat, P: Mat, models: Mat, dt: float) -> None:
    """Carry every filter on by `dt`, each alone, in place.

    Args:
        X: (n, 3) states.
        P: (n, 3, 3) covariances.
        models: (n, 4), `motion_models.table`.
        dt: s.
    """
    filters = _filters(X, P, models, dt)
    for it in filters:
        it.predict()
    _taken(X, P, filters)


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
    unwrap(X, mu)
    bank = IMMEstimator(_filters(X, P, models, dt), mu, M)
    bank.predict()
    if _taken(X, P, bank.filters):
        mu[:] = bank.cbar


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
    filters = _filters(X, P, np.zeros((len(X), 4)), 0.0)
    bank = MMAEFilterBank(filters, mu.copy(), dim_x=3)
    bank.update(z, R)
    if not (np.isfinite(bank.p).all() and _taken(X, P, filters)):
        return False
    mu[:] = bank.p
    limit(mu, least)
    return True


def _filters(X: Mat, P: Mat, models: Mat, dt: float) -> list[_ModelFilter]:
    return [_ModelFilter(x, p, model, dt) for x, p, model in zip(X, P, models, strict=True)]


def _taken(X: Mat, P: Mat, filters: list[_ModelFilter]) -> bool:
    """Put a result in place if all of it is finite."""
    states, covariances = np.array([it.x for it in filters]), np.array([it.P for it in filters])
    if not (np.isfinite(states).all() and np.isfinite(covariances).all()):
        return False
    X[:], P[:] = states, 0.5 * (covariances + covariances.transpose(0, 2, 1))
    return True
