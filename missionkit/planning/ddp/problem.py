"""An optimal control problem in discrete time: dynamics, cost and penalties are plug-in points.

    min over u of  Σ_k L(x_k, u_k) + φ(x_N) + ½ μ Σ_k e(x_k, u_k)²    with  x_{k+1} = f(x_k, u_k)

where e > 0 is how far an inequality is violated: the exterior quadratic penalty of weight μ. There
are N steps, n states and m controls. Each part works on a whole trajectory at a time, so that its
kernel is called once and not once a step.

Source: P4, (29) to (34).
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from missionkit.geometry import Mat


class Trajectory(NamedTuple):
    """States and the controls between them."""

    states: Mat  # (N + 1, n)
    controls: Mat  # (N, m)


class Policy(NamedTuple):
    """What to add to the controls: rate × feedforward + feedback × (deviation of the state)."""

    feedforward: Mat  # (N, m)
    feedback: Mat  # (N, m, n)


class DynamicsDerivatives(NamedTuple):
    """Derivatives of f along a trajectory."""

    by_state: Mat  # (N, n, n), ∂f/∂x
    by_control: Mat  # (N, n, m), ∂f/∂u
    second: Mat  # (N, n, n + m, n + m), of each component by (x, u); (0, …) if f is linear


class CostExpansion(NamedTuple):
    """Gradients and Hessians of the cost at each step; the last of x and xx are those of φ."""

    x: Mat  # (N + 1, n)
    u: Mat  # (N, m)
    xx: Mat  # (N + 1, n, n)
    ux: Mat  # (N, m, n)
    uu: Mat  # (N, m, m)


class Dynamics(Protocol):
    """How the state moves."""

    def roll_out(self, around: Trajectory, policy: Policy, rate: float) -> Trajectory:
        """Return the trajectory from `around.states[0]` under the policy.

        u_k = ū_k + rate l_ff,k + l_fb,k (x_k - x̄_k), with ¯ of `around`.

        Args:
            around: trajectory that the policy belongs to.
            policy: feedforward and feedback.
            rate: of the feedforward, 0 to 1: P4's γ.
        """

    def derivatives(self, at: Trajectory) -> DynamicsDerivatives:
        """Return the derivatives of f along a trajectory."""


class Cost(Protocol):
    """What is to be small."""

    def value(self, at: Trajectory) -> float:
        """Return Σ L + φ."""

    def expand(self, at: Trajectory) -> CostExpansion:
        """Return gradients and Hessians in arrays that the caller may change."""


class Penalty(Protocol):
    """An inequality that is kept by an exterior quadratic penalty."""

    def value(self, at: Trajectory) -> float:
        """Return ½ Σ e², over the steps where the inequality is violated."""

    def violation(self, at: Trajectory) -> float:
        """Return the largest e, in the inequality's own unit; 0 if it holds everywhere."""

    def add_to(self, expansion: CostExpansion, at: Trajectory, weight: float) -> None:
        """Add gradients and Hessians of `weight` × value in place.

        Args:
            expansion: changed in place.
            at: trajectory that it is taken along.
            weight: μ.
        """


class Problem(NamedTuple):
    """What a solver minimises."""

    dynamics: Dynamics
    cost: Cost
    penalties: tuple[Penalty, ...] = ()

    def value(self, at: Trajectory, weight: float) -> float:
        """Return the cost with penalties of this weight."""
        total = self.cost.value(at)
        for penalty in self.penalties:
            total += weight * penalty.value(at)
        return total

    def expand(self, at: Trajectory, weight: float) -> CostExpansion:
        """Return gradients and Hessians of the cost with penalties of this weight."""
        expansion = self.cost.expand(at)
        for penalty in self.penalties:
            penalty.add_to(expansion, at, weight)
        return expansion

    def violation(self, at: Trajectory) -> float:
        """Return the largest violation of any inequality."""
        return max((penalty.violation(at) for penalty in self.penalties), default=0.0)

    def start(self, state: Mat, controls: Mat) -> Trajectory:
        """Return the trajectory from `state` (n,) under `controls` (N, m), open loop."""
        count, m = controls.shape
        states = np.zeros((count + 1, len(state)))
        states[0] = state
        still = Policy(np.zeros((count, m)), np.zeros((count, m, len(state))))
        return self.dynamics.roll_out(Trajectory(states, controls), still, 0.0)
