"""The cheapest landing path, against a direct transcription with free accelerations."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from missionkit.planning.energy_optimal import Airframe, Gate, plan
from missionkit.planning.landing_profiles import LandingLimits
from missionkit.planning.rotor_power import RotorPower, flight_powers

CRAFT = Airframe(1.2, 0.0118, RotorPower().model())
LIMITS = LandingLimits(speed=8.0)
CASES = [(10.0, 2.0), (10.0, 5.0), (20.0, 3.0), (5.0, 3.0)]


class Transcription:
    """N steps of constant acceleration, level and down, and their number of seconds: all free."""

    def __init__(self, distance, height, steps=24):
        self.distance, self.height, self.n = distance, height, steps

    def states(self, u):
        """Speeds at the ends of the steps, mean speeds, accelerations and the step (s)."""
        dt = u[-1] / self.n
        a = u[:-1].reshape(2, self.n)
        ends = np.cumsum(a, axis=1) * dt
        return ends, ends - 0.5 * a * dt, a, dt

    def energy(self, u):
        _, mean, a, dt = self.states(u)
        v, pull = np.zeros((2, self.n, 3))
        v[:, 0], v[:, 2] = mean
        pull[:, 0], pull[:, 2] = a
        return float(flight_powers(v, pull, *CRAFT).sum() * dt)

    def reached(self, u):
        ends, mean, _, dt = self.states(u)
        way, fallen = mean.sum(axis=1) * dt
        return np.array([way - self.distance, fallen - self.height, ends[0, -1]])

    def allowed(self, u):
        (v, w), mean, _, dt = self.states(u)
        fallen = np.cumsum(mean[1]) * dt
        return np.concatenate(
            [
                LIMITS.speed - v,
                v,
                LIMITS.descent - w,
                w,
                [LIMITS.touch_down - w[-1]],
                self.height - fallen,
            ]
        )

    def solve(self):
        """Begin with the planner's path, so that it can only be improved upon."""
        path = plan(self.distance, self.height, CRAFT, LIMITS)
        end = path.times[-1]
        grid = np.linspace(0.0, end, self.n + 1)
        dt = end / self.n
        level = np.diff(np.interp(grid, path.times, path.speed)) / dt
        down = np.diff(np.interp(grid, path.times, path.descent)) / dt
        start = np.concatenate([level, down, [end]])
        a, c = LIMITS.acceleration, LIMITS.vertical_acceleration
        return minimize(
            lambda u: 0.01 * self.energy(u),
            start,
            method="SLSQP",
            bounds=[(-a, a)] * self.n + [(-c, c)] * self.n + [(0.5, 60.0)],
            constraints=[
                {"type": "eq", "fun": self.reached},
                {"type": "ineq", "fun": self.allowed},
            ],
            options={"maxiter": 120, "ftol": 1e-5},
        )


@pytest.mark.parametrize(("distance", "height"), CASES)
def test_free_accelerations_save_next_to_nothing(distance, height):
    free = Transcription(distance, height)
    found = free.solve()
    assert np.abs(free.reached(found.x)).max() < 1e-3
    best = free.energy(found.x)
    ours = plan(distance, height, CRAFT, LIMITS).energy
    assert ours < 1.03 * best
    assert best < 1.02 * ours  # it is a check: the coarse steps cost it no more


@pytest.mark.parametrize(("distance", "height"), CASES)
def test_sideways_first_and_down_late(distance, height):
    path = plan(distance, height, CRAFT, LIMITS)
    half_way = np.interp(0.5 * distance, path.left[::-1], path.height[::-1])
    assert half_way > 0.53 * height
    assert path.left[-1] == pytest.approx(0.0, abs=1e-6)
    assert path.height[-1] == pytest.approx(0.0, abs=1e-6)
    assert path.descent[-1] == pytest.approx(LIMITS.touch_down, abs=1e-6)
    assert (np.diff(path.left) <= 1e-9).all()
    assert (np.diff(path.height) <= 1e-9).all()


@pytest.mark.parametrize(("distance", "height"), CASES)
def test_limits_are_kept(distance, height):
    path = plan(distance, height, CRAFT, LIMITS)
    step = path.times[1]
    assert path.top_speed <= LIMITS.speed + 1e-9
    assert path.descent.max() <= LIMITS.descent + 1e-9
    assert np.abs(np.diff(path.speed)).max() <= LIMITS.acceleration * step + 1e-9
    assert np.abs(np.diff(path.descent)).max() <= LIMITS.vertical_acceleration * step + 1e-9


def test_a_gate_keeps_it_high_until_it_is_near():
    path = plan(10.0, 3.0, CRAFT, LIMITS, Gate(distance=0.5, height=1.4))
    far = path.left > 0.5
    assert (path.height[far] >= 1.4 - 1e-6).all()
    free = plan(10.0, 3.0, CRAFT, LIMITS)
    assert (free.height[free.left > 0.5] < 1.4).any()
    assert path.energy > free.energy
    assert path.energy == pytest.approx(
        plan(10.0, 3.0, CRAFT, LIMITS, Gate(0.5, 1.4)).energy, rel=0.0
    )


def test_a_vehicle_that_comes_fast_is_there_sooner():
    standing = plan(10.0, 3.0, CRAFT, LIMITS)
    moving = plan(10.0, 3.0, CRAFT, LIMITS, closing=4.0)
    assert moving.times[-1] < standing.times[-1]
    assert moving.speed[0] == 4.0
    assert moving.energy < standing.energy


@pytest.mark.parametrize("closing", [0.0, 3.0, 12.0])
@pytest.mark.parametrize(("distance", "height"), [(0.0, 0.0), (0.0, 4.0), (7.0, 0.0), (0.3, 80.0)])
def test_corners_give_numbers(distance, height, closing):
    path = plan(distance, height, CRAFT, LIMITS, Gate(0.2, 1.0), closing)
    assert np.isfinite(path.times).all()
    assert np.isfinite(path.energy)
    assert path.left[-1] == pytest.approx(0.0, abs=1e-6)
