from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from missionkit.geometry import norm, vec
from missionkit.planning.obstacle_braking import (
    NearbyObstacles,
    Stopping,
    admissible_speed,
    braked,
    free_path,
    stopping_distance,
)

HOW = Stopping(width=0.65, deceleration=2.0, reaction=0.5)
speeds = st.floats(-6.0, 6.0)
vectors = st.tuples(speeds, speeds, speeds).map(np.array)
clouds = st.lists(vectors, min_size=1, max_size=8).map(np.array)


def around(*points):
    away = -np.array(points, dtype=float)
    return NearbyObstacles(away, (away**2).sum(axis=1))


@given(st.floats(0.0, 20.0))
def test_admissible_speed_is_the_inverse_of_the_stopping_distance(speed):
    assert admissible_speed(stopping_distance(speed, HOW), HOW) == pytest.approx(speed, abs=1e-9)


@pytest.mark.parametrize("spread", [0.0, 0.05])
def test_free_path_by_marching(spread):
    """Against moving the ball forward in small steps until it touches."""
    rng = np.random.default_rng(5)
    how = HOW._replace(spread=spread)
    for _ in range(40):
        points = rng.uniform(-8.0, 8.0, (6, 3)) * (1, 1, 0.2)
        heading = rng.standard_normal(3) * (1, 1, 0.1)
        heading /= norm(heading)
        points = points[np.linalg.norm(points, axis=1) > 1.2]
        ahead = points @ heading
        width = (HOW.width + spread * ahead)[:, None]
        steps = np.arange(0.0, 12.0, 0.005)
        gaps = np.linalg.norm(points[:, None] - steps[:, None] * heading, axis=2)
        touched = ((gaps < width) & (ahead > 0)[:, None]).any(axis=0)
        expected = steps[touched.argmax()] if touched.any() else math.inf
        got = free_path(around(*points), heading, how)
        assert got == pytest.approx(expected, abs=0.2 if spread else 0.05)


@given(vectors, vectors, clouds)
def test_the_command_can_always_be_stopped_and_never_grows(velocity, actual, points):
    near = around(*points)
    got = braked(velocity, actual, near, HOW)
    assert np.isfinite(got).all()
    size = norm(got)
    if size > 0.1 and norm(actual) < 0.05:
        free = free_path(near, got / size, HOW)
        assert size <= admissible_speed(free, HOW) + 1e-6
        assert size <= norm(velocity) + 1e-9


def test_sliding_along_a_wall_is_free_and_leaving_it_too():
    wall = around(*[(1.0, y, 0.0) for y in np.arange(-6.0, 6.0, 0.3)])
    np.testing.assert_array_equal(braked(vec(0, 3, 0), vec(0, 3, 0), wall, HOW), vec(0, 3, 0))
    np.testing.assert_array_equal(braked(vec(-3, 0, 0), vec(-1, 0, 0), wall, HOW), vec(-3, 0, 0))


def test_motion_under_way_is_braked_even_if_the_command_turns_off():
    ahead = around((3.0, 0.0, 0.0))
    got = braked(vec(4, 2, 0), vec(5, 0, 0), ahead, HOW)
    top = admissible_speed(3.0 - 0.65, HOW)
    assert got[0] <= 2.0 * top - 5.0 + 1e-9
