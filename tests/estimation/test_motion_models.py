"""Models of motion against finite differences, the true robot, sampled noise and filterpy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter

from missionkit.estimation.target_tracking import motion_models as mm
from missionkit.ground_robot import GroundRobot
from missionkit.sim.ground_robots import advance, placed, random_offsets

ROBOT = GroundRobot()
MODELS = [f(ROBOT) for f in (mm.straight, mm.spin, mm.circling, mm.standing)]
every_model = pytest.mark.parametrize("model", MODELS, ids=["straight", "spin", "circle", "stand"])
DT = 0.05


@every_model
def test_the_jacobian_is_that_of_finite_differences(model):
    row, rng = np.array(model), np.random.default_rng(0)
    for x in rng.normal(0.0, 2.0, (20, 3)):
        F = mm.jacobian(x, row, 0.4)
        for k in range(3):
            step = np.zeros(3)
            step[k] = 1e-6
            slope = (mm.moved(x + step, row, 0.4) - mm.moved(x - step, row, 0.4)) / 2e-6
            assert F[:, k] == pytest.approx(slope, abs=1e-8)


@every_model
def test_two_half_steps_are_one(model):
    row, P = np.array(model), np.diag([0.1, 0.2, 0.05])
    x = np.array([1.0, -2.0, 0.7])
    halved, P_halved = x.copy(), P.copy()
    mm.predict(x, P, row, 0.2)
    mm.predict(halved, P_halved, row, 0.1)
    mm.predict(halved, P_halved, row, 0.1)
    assert halved == pytest.approx(x)
    np.testing.assert_allclose(P_halved, P, atol=2e-5)  # the noise is taken along the chord


def test_noise_is_what_sampled_paths_spread():
    row, rng = np.array(mm.straight(ROBOT)), np.random.default_rng(1)
    x0, T, n = np.array([0.0, 0.0, 0.3]), 1.0, 40
    ends = np.tile(x0, (4000, 1))
    for _ in range(n):
        kicks = rng.normal(0.0, math.sqrt(row[3] * T / n), len(ends))
        ends[:, :2] += row[0] * T / n * np.stack(
            (np.cos(ends[:, 2]), np.sin(ends[:, 2])), axis=1
        ) + rng.normal(0.0, math.sqrt(row[2] * T / n), (len(ends), 2))
        ends[:, 2] += kicks
    assert np.cov(ends.T) == pytest.approx(mm.process_noise(x0, row, T), rel=0.12, abs=3e-6)


def test_models_move_as_the_robot_does():
    offsets, wide = np.zeros((1, 9)), ROBOT._replace(turn_every=1e9)
    for phase, obstacles, model in ((9.0, 0, MODELS[0]), (0.0, 0, MODELS[1]), (9.0, 1, MODELS[2])):
        robots = placed(
            np.zeros((1, 2)), np.array([0.4]), np.array([phase]), wide, obstacles=obstacles
        )
        advance(robots, offsets, wide, 1.5)
        assert robots[0, :3] == pytest.approx(
            mm.moved(np.array([0.0, 0.0, 0.4]), np.array(model), 1.5)
        )


def test_the_noise_of_the_heading_is_that_of_the_robot_s_random_turns():
    rng, n = np.random.default_rng(2), 300
    long = ROBOT._replace(reversal_every=1e9)
    robots = placed(np.zeros((n, 2)), np.zeros(n), rng.uniform(200, 300, n), long, obstacles=0)
    advance(robots, random_offsets(rng, n, 110.0, long), long, 100.0)
    variance = mm.straight(ROBOT).heading_noise * 100.0
    assert robots[:, 2].var() == pytest.approx(variance, rel=0.25)


@every_model
def test_a_step_is_filterpy_s(model):
    row, rng = np.array(model), np.random.default_rng(3)
    x, P = np.array([0.2, 0.1, -0.4]), np.diag([0.02, 0.03, 0.2])
    R = np.array([[2e-4, 5e-5], [5e-5, 3e-4]])
    theirs = KalmanFilter(3, 2)
    theirs.H = np.eye(2, 3)
    theirs.x, theirs.P, theirs.R = x.copy(), P.copy(), R
    for z in rng.normal(0.2, 0.05, (30, 2)):
        theirs.F, theirs.Q = mm.jacobian(x, row, DT), mm.process_noise(x, row, DT)
        after = mm.moved(theirs.x, row, DT)
        theirs.predict()
        theirs.x = after
        mm.predict(x, P, row, DT)
        density = mm.update(x, P, z, R)
        theirs.update(z)
        assert x == pytest.approx(theirs.x, abs=1e-9)
        np.testing.assert_allclose(P, theirs.P, atol=1e-9)
        assert density == pytest.approx(theirs.log_likelihood, abs=1e-7)
