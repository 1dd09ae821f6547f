"""Gentle AdaBoost with stumps: one stage of a cascade.

F ← F + f_m, where f_m is the weighted least-squares fit of a stump to y = ±1, then
w ← w exp(-y f_m). Source: J. Friedman, T. Hastie, R. Tibshirani, "Additive Logistic Regression",
2000, algorithm 4.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


class Stump(NamedTuple):
    """A feature and what it says: `low` below the threshold, else `high`."""

    feature: int
    threshold: float
    low: float
    high: float

    def answers(self, values: npt.NDArray[np.float32]) -> Floats:
        """Return its answer to each value of its feature (n,)."""
        return np.where(values < self.threshold, self.low, self.high)


class Stage(NamedTuple):
    """Stumps whose sum passes a window if it reaches the limit."""

    stumps: tuple[Stump, ...]
    limit: float


class StageGoal(NamedTuple):
    """When a stage is good enough."""

    keep: float = 0.9995  # least share of the positives that pass
    let_through: float = 0.4  # largest share of the negatives that do
    most_stumps: int = 40


def boosted(values: npt.NDArray[np.float32], y: Floats, goal: StageGoal) -> Stage:
    """Return one stage.

    Args:
        values: (features, n), of each feature in each sample.
        y: (n,), 1 an object, -1 not.
        goal: when to stop.
    """
    from missionkit.perception.haar.kernels import best_stump  # noqa: PLC0415 compiles

    order = np.argsort(values, axis=1, kind="stable").astype(np.int32)
    w = np.where(y > 0, 0.5 / (y > 0).sum(), 0.5 / (y < 0).sum())
    F = np.zeros(len(y))
    stumps: list[Stump] = []
    limit = 0.0
    while len(stumps) < goal.most_stumps:
        stump = Stump(*best_stump(values, order, w, y))
        f = stump.answers(values[stump.feature])
        F += f
        w = w * np.exp(-y * f)
        w /= w.sum()
        stumps.append(stump)
        limit = float(np.quantile(F[y > 0], 1.0 - goal.keep, method="lower")) - 1e-9
        if (F[y < 0] >= limit).mean() <= goal.let_through:
            break
    return Stage(tuple(stumps), limit)
