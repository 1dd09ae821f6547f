"""Compiling the planner's kernels, or loading them from their cache, before a flight needs them."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np

from missionkit.messages.occupancy import Occupancy


@cache
def warm_up() -> None:
    """Plan past one wall, and see that the path is free."""
    from missionkit.planning.path_blockage import in_the_way, walled  # noqa: PLC0415
    from missionkit.planning.route_planning import Way, plan  # noqa: PLC0415

    costs = np.ones((5, 5))
    costs[2, :2] = np.inf
    known = Occupancy(costs, 1.0, (0.0, 0.0))
    spots = plan(known, (0.5, 0.5), (4.5, 0.5), Way(0.2, smooth=True)).spots
    walled(known, pairwise(spots))
    in_the_way(np.zeros((1, 3)), pairwise(spots), 0.1, spots[0])
