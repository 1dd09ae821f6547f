"""The probability that what a detector found is an object, and how it is fitted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from missionkit.units import Number

RIDGE: Final = 0.5
"""Of the slopes' penalty: few wrong detections, or none, must not make it sure of everything."""


class ScoreLaw(BaseModel):
    """Probability that what was found is an object: logistic in what the detector said of it.

    Source: J. Platt, "Probabilistic Outputs for Support Vector Machines", 1999.
    """

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)

    bias: Number = 0.0
    margin: Number = Field(default=0.3, description="of what is found beyond what is asked for")
    windows: Number = Field(default=0.5, description="of the logarithm of how often it is found")

    def score(self, margin: float, windows: int) -> float:
        """Return the probability.

        Args:
            margin: what the detector found beyond what it asks for.
            windows: how often, at neighbouring places and sizes.
        """
        z = self.bias + self.margin * margin + self.windows * float(np.log(windows))
        return float(1.0 / (1.0 + np.exp(-np.clip(z, -30.0, 30.0))))


def fitted(right: Sequence[tuple[float, int]], wrong: Sequence[tuple[float, int]]) -> ScoreLaw:
    """Return the logistic law of best fit, by Newton's method.

    Args:
        right: margin and windows of each object that was found.
        wrong: of what was found and is none.
    """
    rows = np.array([(1.0, margin, np.log(count)) for margin, count in (*right, *wrong)])
    y = np.array([1.0] * len(right) + [0.0] * len(wrong))
    if not len(rows):
        return ScoreLaw()
    b, penalty = np.zeros(3), np.diag([1e-3, RIDGE, RIDGE])
    for _ in range(30):
        p = 1.0 / (1.0 + np.exp(-np.clip(rows @ b, -30.0, 30.0)))
        hessian = (rows * (p * (1.0 - p))[:, None]).T @ rows + penalty
        b = b + np.linalg.solve(hessian, rows.T @ (y - p) - penalty @ b)
    bias, slope, windows = (round(float(it), 4) for it in b)
    return ScoreLaw(bias=bias, margin=max(slope, 0.0), windows=max(windows, 0.0))
