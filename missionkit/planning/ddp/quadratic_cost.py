"""½ (x - x*)ᵀ Q (x - x*) + ½ uᵀ R u at each step, and the same of the last state: P4, (34)."""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Mat
from missionkit.jit import compiled
from missionkit.planning.ddp.problem import CostExpansion, Trajectory


class QuadraticCost:
    """Diagonal weights on states and controls, and on the last state.

    Args:
        target: (n,), x*, or (N + 1, n), one for each step.
        state_weights: (n,), Q, not negative.
        control_weights: (m,), R, more than 0.
        final_weights: (n,), of φ, not negative.
        steps: N.

    Raises:
        ValueError: a number is not finite, or a weight has the wrong sign.
    """

    def __init__(
        self, target: Mat, state_weights: Mat, control_weights: Mat, final_weights: Mat, steps: int
    ) -> None:
        n = len(state_weights)
        self.target = np.ascontiguousarray(np.broadcast_to(target, (steps + 1, n)))
        weights = np.concatenate([state_weights, final_weights, control_weights])
        if not (np.isfinite(self.target).all() and np.isfinite(weights).all()):
            raise ValueError("the target and the weights of the cost must be finite")
        if weights.min() < 0.0 or min(control_weights) <= 0.0:
            raise ValueError("weights must not be negative, and those of controls not 0")
        self._q = np.tile(np.asarray(state_weights, dtype=float), (steps + 1, 1))
        self._q[-1] = final_weights
        self._r = np.ascontiguousarray(control_weights, dtype=float)
        self._xx, self._uu = np.zeros((steps + 1, n, n)), np.zeros((steps, *2 * self._r.shape))
        self._xx[:, range(n), range(n)] = self._q
        self._uu[:, range(len(self._r)), range(len(self._r))] = self._r

    def value(self, at: Trajectory) -> float:
        """Return Σ L + φ; infinite if it is not a number."""
        total = float(value(at.states, at.controls, self.target, self._q, self._r))
        return total if math.isfinite(total) else math.inf

    def expand(self, at: Trajectory) -> CostExpansion:
        """Return gradients and Hessians."""
        count, m = at.controls.shape
        return CostExpansion(
            self._q * (at.states - self.target),
            self._r * at.controls,
            self._xx.copy(),
            np.zeros((count, m, at.states.shape[1])),
            self._uu.copy(),
        )


@compiled
def value(states: Mat, controls: Mat, target: Mat, q: Mat, r: Mat) -> float:
    """Return Σ ½ q (x - x*)² + Σ ½ r u².

    Args:
        states: (N + 1, n).
        controls: (N, m).
        target: (N + 1, n), x*.
        q: (N + 1, n), diagonals of Q; the last is that of φ.
        r: (m,), diagonal of R.
    """
    total = 0.0
    for k in range(len(states)):
        for i in range(states.shape[1]):
            gap = states[k, i] - target[k, i]
            total += q[k, i] * gap * gap
    for k in range(len(controls)):
        for i in range(controls.shape[1]):
            total += r[i] * controls[k, i] * controls[k, i]
    return 0.5 * total
