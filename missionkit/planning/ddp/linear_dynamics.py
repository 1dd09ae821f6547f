"""x_{k+1} = A x_k + B u_k, and the double integrator of a vehicle commanded by acceleration."""

from __future__ import annotations

import numpy as np

from missionkit.geometry import Mat
from missionkit.jit import compiled
from missionkit.planning.ddp.problem import DynamicsDerivatives, Policy, Trajectory


class LinearDynamics:
    """The same A (n, n) and B (n, m) at each of `steps` steps."""

    def __init__(self, A: Mat, B: Mat, steps: int) -> None:
        self.A, self.B = np.ascontiguousarray(A), np.ascontiguousarray(B)
        n, m = B.shape
        self._derivatives = DynamicsDerivatives(
            np.tile(self.A, (steps, 1, 1)),
            np.tile(self.B, (steps, 1, 1)),
            np.zeros((0, n, n + m, n + m)),
        )

    def roll_out(self, around: Trajectory, policy: Policy, rate: float) -> Trajectory:
        """Return the trajectory from `around.states[0]` under the policy.

        Args:
            around: N steps; only its first state is kept.
            policy: around `around`.
            rate: of the feedforward, 0 to 1.
        """
        states, controls = roll_out(
            self.A,
            self.B,
            around.states,
            around.controls,
            policy.feedforward,
            policy.feedback,
            float(rate),
        )
        return Trajectory(states, controls)

    def derivatives(self, at: Trajectory) -> DynamicsDerivatives:  # noqa: ARG002 - the same anywhere
        """Return A and B for each step."""
        return self._derivatives


def double_integrator(steps: int, dt: float) -> LinearDynamics:
    """Return a point with state (position, velocity) (6,) and control acceleration (3,).

    The acceleration is constant over a step, for which the discretisation is exact.

    Source: P4, (31) and (32).

    Args:
        steps: N.
        dt: s, of a step.
    """
    one, none = np.eye(3), np.zeros((3, 3))
    A = np.block([[one, dt * one], [none, one]])
    B = np.vstack([0.5 * dt * dt * one, dt * one])
    return LinearDynamics(A, B, steps)


@compiled
def roll_out(
    A: Mat, B: Mat, states: Mat, controls: Mat, feedforward: Mat, feedback: Mat, rate: float
) -> tuple[Mat, Mat]:
    """Return states (N + 1, n) and controls (N, m) under the policy around the ones given.

    Args:
        A: (n, n).
        B: (n, m).
        states: (N + 1, n), x̄.
        controls: (N, m), ū.
        feedforward: (N, m).
        feedback: (N, m, n).
        rate: of the feedforward, 0 to 1.
    """
    count, m = controls.shape
    n = states.shape[1]
    xs, us = np.empty((count + 1, n)), np.empty((count, m))
    xs[0] = states[0]
    for k in range(count):
        for i in range(m):
            u = controls[k, i] + rate * feedforward[k, i]
            for j in range(n):
                u += feedback[k, i, j] * (xs[k, j] - states[k, j])
            us[k, i] = u
        for i in range(n):
            x = 0.0
            for j in range(n):
                x += A[i, j] * xs[k, j]
            for j in range(m):
                x += B[i, j] * us[k, j]
            xs[k + 1, i] = x
    return xs, us
