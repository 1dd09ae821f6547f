"""Compiling the search, or loading it from its cache, before a flight needs it."""

from __future__ import annotations

from functools import cache

import numpy as np

from missionkit.perception.apparent_size import SizeGate
from missionkit.perception.haar.cascade import shipped
from missionkit.perception.haar.window_search import objects


@cache
def warm_up() -> None:
    """Search a small empty image."""
    it, gate = shipped(), SizeGate(np.array([0.0, 0.0, 20.0]), 1.0, 4.0)
    image = np.zeros((48, 48), np.uint8)
    objects(image, it.arrays, it.side, it.width, gate, (20.0, 22.0))
