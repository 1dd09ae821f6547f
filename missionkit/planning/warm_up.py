"""Compiling the planner's kernels, or loading them from their cache, before a flight needs them."""

from __future__ import annotations

import numpy as np

from missionkit.messages.occupancy import Occupancy


def warm_up() -> None:
    """Plan past one wall."""
    from missionkit.planning.route import Way, plan  # noqa: PLC0415

    costs = np.ones((5, 5))
    costs[2, :2] = np.inf
    plan(Occupancy(costs, 1.0, (0.0, 0.0)), (0.5, 0.5), (4.5, 0.5), Way(0.2, smooth=True))
