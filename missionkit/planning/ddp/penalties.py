"""Inequalities kept by an exterior quadratic penalty: a largest length, and keep-out cylinders.

Source: P4 section IV, correction P4.2.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled
from missionkit.planning.ddp.problem import CostExpansion, Trajectory

TINY = 1e-9


class NormLimit(NamedTuple):
    """|z| <= limit for a run z of the states or of the controls: a speed, an acceleration.

    With e = |z| - limit > 0 the Hessian is z zᵀ/|z|² + (e/|z|) (I - z zᵀ/|z|²).
    """

    of: Literal["states", "controls"]
    first: int  # component
    last: int  # component, included
    limit: float

    def value(self, at: Trajectory) -> float:
        """Return ½ Σ e²."""
        return float(norm_sum(self._values(at), self.first, self.last + 1, self.limit)[0])

    def violation(self, at: Trajectory) -> float:
        """Return the largest e."""
        return float(norm_sum(self._values(at), self.first, self.last + 1, self.limit)[1])

    def add_to(self, expansion: CostExpansion, at: Trajectory, weight: float) -> None:
        """Add gradients and Hessians in place.

        Args:
            expansion: changed in place.
            at: trajectory that it is taken along.
            weight: μ.
        """
        g, H = (expansion.u, expansion.uu) if self.of == "controls" else (expansion.x, expansion.xx)
        skip = 0 if self.of == "controls" else 1
        values = self._values(at)
        norm_add(values, g[skip:], H[skip:], self.first, self.last + 1, self.limit, float(weight))

    def _values(self, at: Trajectory) -> Mat:
        """Return what can still be changed: the first state cannot."""
        return at.controls if self.of == "controls" else at.states[1:]


class KeepOut:
    """Stay `radii` away, level, from obstacles that move: the first two states are north, east.

    An obstacle counts as a cylinder of any height, at each step where it is then. Between two steps
    the distance is not checked: at a step of s metres it is at most s²/(8 r) less. The Hessian is
    that of Gauss and Newton, n nᵀ, which is never negative.

    Args:
        centres: (count, N + 1, 2), m.
        radii: (count,), m.

    Raises:
        ValueError: a number is not finite.
    """

    def __init__(self, centres: Mat, radii: Vec3) -> None:
        if not (np.isfinite(centres).all() and np.isfinite(radii).all()):
            raise ValueError("the obstacles' places and radii must be finite")
        self.centres = np.ascontiguousarray(centres, dtype=float)
        self.radii = np.ascontiguousarray(radii, dtype=float)

    def value(self, at: Trajectory) -> float:
        """Return ½ Σ e²."""
        return float(keep_out_sum(at.states, self.centres, self.radii)[0])

    def violation(self, at: Trajectory) -> float:
        """Return the largest e (m)."""
        return float(keep_out_sum(at.states, self.centres, self.radii)[1])

    def add_to(self, expansion: CostExpansion, at: Trajectory, weight: float) -> None:
        """Add gradients and Hessians in place.

        Args:
            expansion: changed in place.
            at: trajectory that it is taken along.
            weight: μ, 1/m².
        """
        keep_out_add(at.states, expansion.x, expansion.xx, self.centres, self.radii, float(weight))


@compiled
def norm_sum(values: Mat, first: int, end: int, limit: float) -> tuple[float, float]:
    """Return ½ Σ e² and the largest e of e = |z| - limit > 0.

    Args:
        values: (N, n), states or controls.
        first: index of the first component of z.
        end: index after the last.
        limit: of |z|, in its unit.
    """
    total, worst = 0.0, 0.0
    for k in range(len(values)):
        square = 0.0
        for i in range(first, end):
            square += values[k, i] * values[k, i]
        if square > limit * limit:
            e = np.sqrt(square) - limit
            total += 0.5 * e * e
            worst = max(worst, e)
    return total, worst


@compiled
def norm_add(
    values: Mat, g: Mat, H: Mat, first: int, end: int, limit: float, weight: float
) -> None:
    """Add gradients to g (N, n) and Hessians to H (N, n, n).

    Args:
        values: (N, n), states or controls.
        g: (N, n), changed in place.
        H: (N, n, n), changed in place.
        first: index of the first component of z.
        end: index after the last.
        limit: of |z|, in its unit.
        weight: μ.
    """
    for k in range(len(values)):
        square = 0.0
        for i in range(first, end):
            square += values[k, i] * values[k, i]
        if square <= limit * limit:
            continue
        size = np.sqrt(square)
        along = (size - limit) / size
        for i in range(first, end):
            g[k, i] += weight * along * values[k, i]
            H[k, i, i] += weight * along
            for j in range(first, end):
                H[k, i, j] += weight * (1.0 - along) * values[k, i] * values[k, j] / square


@compiled
def keep_out_sum(states: Mat, centres: Mat, radii: Vec3) -> tuple[float, float]:
    """Return ½ Σ e² and the largest e of e = radius - distance > 0.

    Args:
        states: (N + 1, n), m, north and east first.
        centres: (count, N + 1, 2), m, where each obstacle is at each step.
        radii: (count,), m.
    """
    total, worst = 0.0, 0.0
    for o in range(len(radii)):
        for k in range(1, len(states)):
            north = states[k, 0] - centres[o, k, 0]
            east = states[k, 1] - centres[o, k, 1]
            square = north * north + east * east
            if square < radii[o] * radii[o]:
                e = radii[o] - np.sqrt(square)
                total += 0.5 * e * e
                worst = max(worst, e)
    return total, worst


@compiled
def keep_out_add(states: Mat, g: Mat, H: Mat, centres: Mat, radii: Vec3, weight: float) -> None:
    """Add gradients to g (N + 1, n) and Hessians to H (N + 1, n, n).

    Args:
        states: (N + 1, n), m, north and east first.
        g: (N + 1, n), changed in place.
        H: (N + 1, n, n), changed in place.
        centres: (count, N + 1, 2), m, where each obstacle is at each step.
        radii: (count,), m.
        weight: μ, 1/m².
    """
    for o in range(len(radii)):
        for k in range(1, len(states)):
            north = states[k, 0] - centres[o, k, 0]
            east = states[k, 1] - centres[o, k, 1]
            square = north * north + east * east
            if square >= radii[o] * radii[o]:
                continue
            size = max(np.sqrt(square), TINY)
            push = weight * (radii[o] - size)
            a, b = north / size, east / size
            g[k, 0] -= push * a
            g[k, 1] -= push * b
            H[k, 0, 0] += weight * a * a
            H[k, 0, 1] += weight * a * b
            H[k, 1, 0] += weight * a * b
            H[k, 1, 1] += weight * b * b
