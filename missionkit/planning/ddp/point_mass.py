"""The flight of a point to a target state, within limits, round obstacles that move, as a problem.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Mat
from missionkit.planning.ddp.linear_dynamics import LinearDynamics, double_integrator
from missionkit.planning.ddp.penalties import KeepOut, NormLimit
from missionkit.planning.ddp.problem import Penalty, Problem
from missionkit.planning.ddp.quadratic_cost import QuadraticCost


class Horizon(NamedTuple):
    """How far ahead it plans."""

    steps: int = 40
    dt: float = 0.1  # s

    @property
    def duration(self) -> float:
        """Its length (s)."""
        return self.steps * self.dt


class MotionLimits(NamedTuple):
    """What the vehicle may do, in any direction: P4, section V."""

    speed: float = 2.13  # m/s
    acceleration: float = 3.05  # m/s²


class MotionWeights(NamedTuple):
    """Diagonal weights: of a second along the way, and of the end."""

    position: float = 1.0  # 1/(m² s)
    velocity: float = 0.1  # s²/(m² s)
    acceleration: float = 0.1  # s⁴/(m² s)
    final_position: float = 10.0  # 1/m²
    final_velocity: float = 10.0  # s²/m²


class Obstacle(NamedTuple):
    """What the vehicle must not come near, and how it moves."""

    place: tuple[float, float]  # m, north, east, now
    velocity: tuple[float, float]  # m/s
    radius: float  # m, to be kept from its centre


class Flight(NamedTuple):
    """Where to fly and how: what a plan is asked for."""

    target: Mat  # (6,), m and m/s, x*, or (N + 1, 6), one for each step
    limits: MotionLimits = MotionLimits()
    obstacles: tuple[Obstacle, ...] = ()  # they keep their velocities
    weights: MotionWeights = MotionWeights()
    horizon: Horizon = Horizon()

    def problem(self) -> Problem:
        """Return the optimal control problem.

        Raises:
            ValueError: a number is not finite, or a limit is not more than 0.
        """
        if not all(0.0 < limit < math.inf for limit in self.limits):
            raise ValueError("the limits of speed and acceleration must be finite and more than 0")
        (steps, dt), weights = self.horizon, self.weights
        cost = QuadraticCost(
            self.target,
            dt * np.repeat((weights.position, weights.velocity), 3),
            np.full(3, dt * weights.acceleration),
            np.repeat((weights.final_position, weights.final_velocity), 3),
            steps,
        )
        penalties: tuple[Penalty, ...] = (
            NormLimit("states", 3, 5, self.limits.speed),
            NormLimit("controls", 0, 2, self.limits.acceleration),
        )
        if self.obstacles:
            penalties = (*penalties, self._keep_out())
        return Problem(_dynamics(steps, dt), cost, penalties)

    def _keep_out(self) -> KeepOut:
        times = self.horizon.dt * np.arange(self.horizon.steps + 1)[:, None]
        centres = [np.array(it.place) + times * np.array(it.velocity) for it in self.obstacles]
        return KeepOut(np.array(centres), np.array([it.radius for it in self.obstacles]))


@cache
def _dynamics(steps: int, dt: float) -> LinearDynamics:
    return double_integrator(steps, dt)
