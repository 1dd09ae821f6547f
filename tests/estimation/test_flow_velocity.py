"""Rate, height and tilt compensation against the picture of a moving camera."""

from __future__ import annotations

import numpy as np
import pytest

from missionkit.estimation.optical_flow.flow_velocity import over_ground
from missionkit.geometry import conjugate, exp, from_euler, multiply, rotate, vec


def picture(spot, place, q):
    """Image (2,) of a spot on the ground, in normalised coordinates about the body's z."""
    x, y, z = rotate(conjugate(q), spot - place)
    return np.array([x / z, y / z])


def seen(place, velocity, q, rates, h=1e-6):
    """Motion (rad/s) of the spot that is on the axis now, by central differences."""
    down = rotate(q, vec(0, 0, 1))
    spot = place + down * (-place[2] / down[2])
    ahead = picture(spot, place + h * velocity, multiply(q, exp(h * rates)))
    behind = picture(spot, place - h * velocity, multiply(q, exp(-h * rates)))
    return (ahead - behind) / (2 * h)


@pytest.mark.parametrize("seed", range(20))
def test_velocity_comes_back_whatever_the_vehicle_does(seed):
    rng = np.random.default_rng(seed)
    place = vec(3.0, -2.0, -rng.uniform(0.5, 8.0))
    velocity, rates = rng.normal(size=3), rng.normal(size=3)
    q = from_euler(*rng.uniform(-0.5, 0.5, 2), rng.uniform(-3, 3))
    out = np.empty(2)
    flow = seen(place, velocity, q, rates)
    assert over_ground(flow, rates, -place[2], q, -velocity[2], out)
    np.testing.assert_allclose(out, velocity[:2], atol=1e-6)


def test_a_turn_that_is_not_taken_out_passes_for_a_velocity():
    q, rates = from_euler(0, 0, 0), vec(0.1, 0.2, 0.0)
    out = np.empty(2)
    flow = seen(vec(0, 0, -2), np.zeros(3), q, rates)
    assert over_ground(flow, np.zeros(3), 2.0, q, 0.0, out)
    np.testing.assert_allclose(out, [2.0 * 0.2, -2.0 * 0.1], atol=1e-9)


@pytest.mark.parametrize("height", [0.0, -1.0, np.nan])
def test_without_height_there_is_no_velocity(height):
    assert not over_ground(np.zeros(2), np.zeros(3), height, from_euler(0, 0, 0), 0.0, np.empty(2))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_bad_flow_gives_no_velocity(bad):
    flow = np.array([0.1, bad])
    assert not over_ground(flow, np.zeros(3), 2.0, from_euler(0, 0, 0), 0.0, np.empty(2))


def test_on_its_side_the_vehicle_does_not_see_the_ground():
    q = from_euler(1.2, 0.0, 0.0)
    assert not over_ground(np.zeros(2), np.zeros(3), 2.0, q, 0.0, np.empty(2))
