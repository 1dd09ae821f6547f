"""The exact solution of a flight without obstacles: a convex problem, by scipy's SLSQP."""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize


class ExactFlight:
    """Cost and limits as functions of the controls alone, with gradients."""

    def __init__(self, flight, state):
        self.problem, self.limits = flight.problem(), flight.limits
        self.count = flight.horizon.steps
        self.free = self.problem.start(state, np.zeros((self.count, 3))).states
        moved = np.zeros((3 * self.count, *self.free.shape))
        for k, unit in enumerate(np.eye(3 * self.count)):
            at = self.problem.start(np.zeros(6), unit.reshape(-1, 3))
            moved[k] = at.states
        self.moved = moved

    def states(self, u):
        return self.free + np.tensordot(u, self.moved, 1)

    def at(self, u):
        return self.problem.start(self.free[0], u.reshape(-1, 3))

    def cost(self, u):
        at = self.at(u)
        slopes = self.problem.cost.expand(at)
        by_state = np.tensordot(self.moved, slopes.x, 2)
        return self.problem.cost.value(at), by_state + slopes.u.ravel()

    def room(self, u):
        """Squares of the limits less those of speeds and accelerations."""
        v, a = self.states(u)[1:, 3:], u.reshape(-1, 3)
        return np.concatenate(
            [
                self.limits.speed**2 - (v * v).sum(axis=1),
                self.limits.acceleration**2 - (a * a).sum(axis=1),
            ]
        )

    def room_slopes(self, u):
        v, a = self.states(u)[1:, 3:], u.reshape(-1, 3)
        by_speed = -2.0 * np.einsum("kni,ni->nk", self.moved[:, 1:, 3:], v)
        by_acceleration = np.zeros((self.count, 3 * self.count))
        for n in range(self.count):
            by_acceleration[n, 3 * n : 3 * n + 3] = -2.0 * a[n]
        return np.concatenate([by_speed, by_acceleration])

    def least(self):
        """Return the least cost, and how far its controls are from keeping the limits."""
        found = minimize(
            self.cost,
            np.zeros(3 * self.count),
            jac=True,
            method="SLSQP",
            constraints=[{"type": "ineq", "fun": self.room, "jac": self.room_slopes}],
            options={"maxiter": 200, "ftol": 1e-7},
        )
        return found.fun, float(self.room(found.x).min())
