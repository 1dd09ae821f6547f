"""The field against scipy's numeric gradient of its potential."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import approx_fprime

from missionkit.geometry import norm, vec
from missionkit.planning import firas

POINTS = np.random.default_rng(4).uniform(-2.0, 2.0, (20, 3)) + vec(2.5, 0, 0)
P = vec(0.1, 0.2, -0.3)


def slope(function, at):
    return approx_fprime(at, function, 1e-7)


def test_attraction_is_minus_the_gradient():
    goal = vec(4, -5, 6)
    expected = -slope(lambda p: firas.attractive_potential(p, goal, 0.7), P)
    np.testing.assert_allclose(firas.attraction(P, goal, 0.7), expected, atol=1e-5)


@pytest.mark.parametrize("weights", [1.0, np.linspace(0.2, 5.0, len(POINTS))])
@pytest.mark.parametrize("body", [0.0, 0.35])
@pytest.mark.parametrize("gain", [vec(1, 1, 1), vec(1.5, 1.5, 0.5)])
def test_repulsion_is_minus_half_the_gradient_per_axis(gain, body, weights):
    gradient = slope(lambda p: firas.repulsive_potential(p, POINTS, 3.0, body, weights), P)
    got = firas.repulsion(P, POINTS, 3.0, gain, body, weights)
    np.testing.assert_allclose(got, -0.5 * gain * gradient, rtol=1e-4, atol=1e-5)


def test_repulsion_points_away_in_the_form_p1_prints_with_its_sign_corrected():
    obstacle, p, r = vec(1, 1, 0), vec(0, 0, 0), 3.0
    d = norm(p - obstacle)
    expected = 2.0 * (1 / d - 1 / r) / d**3 * (p - obstacle)
    got = firas.repulsion(p, obstacle[None], r, vec(2, 2, 2))
    np.testing.assert_allclose(got, expected)
    assert got @ (p - obstacle) > 0.0


def test_nothing_beyond_the_influence_radius():
    assert not firas.repulsion(vec(0, 0, 0), vec(3.01, 0, 0)[None], 3.0, vec(1, 1, 1)).any()


def mean(points, gain=(1.0, 1.0, 1.0), weights=1.0):
    away, gain = P - points, np.array(gain)
    return firas.mean_repulsion(away, np.linalg.norm(away, axis=1), 3.0, gain, 0.0, weights)


def test_mean_of_one_point_is_p1s():
    gain = vec(1.5, 1.5, 0.5)
    np.testing.assert_allclose(mean(POINTS[:1], gain), firas.repulsion(P, POINTS[:1], 3.0, gain))


def test_mean_does_not_depend_on_how_finely_a_wall_is_seen():
    def wall(n):
        return np.column_stack([np.full(n, 1.5), np.linspace(-4, 4, n), np.full(n, -0.3)])

    np.testing.assert_allclose(mean(wall(81)), mean(wall(801)), rtol=0.02, atol=1e-3)
    assert norm(mean(np.repeat(POINTS, 5, axis=0)) - mean(POINTS)) < 1e-12


def test_the_mean_of_one_heavy_point_is_p1s_with_its_own_gain():
    one = POINTS[:1]
    np.testing.assert_allclose(mean(one, weights=3.0), firas.repulsion(P, one, 3.0, vec(3, 3, 3)))


def test_the_heavier_of_two_pushes_wins():
    both = np.array([P + vec(1, 0, 0), P - vec(1, 0, 0)])
    assert mean(both, weights=np.array([4.0, 1.0]))[0] < -0.1


def test_equal_pushes_cancel():
    assert norm(mean(np.array([P + vec(1, 0, 0), P - vec(1, 0, 0)]))) < 1e-12
