"""Compiling the kernels, or loading them from their cache, before a flight needs them."""

from __future__ import annotations

from functools import cache

import numpy as np

from missionkit.planning.ddp.flight_plan import plan_flight
from missionkit.planning.ddp.point_mass import Flight, Obstacle


@cache
def warm_up() -> None:
    """Plan past one obstacle; some milliseconds, or as many seconds as compiling takes."""
    flight = Flight(np.array([9.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    beside = Obstacle((2.0, 0.1), (0.0, 0.0), 0.5)
    plan_flight(flight._replace(obstacles=(beside,)), np.zeros(6))
