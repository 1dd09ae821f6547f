from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import integrate

from missionkit.planning.spiral_search import SpiralPath

STEADY = SpiralPath.steady(1.5, footprint=2.0, outer=8.0)
PAPER = SpiralPath.paper(0.2, 0.6, speed=1.5, footprint=3.0, outer=8.0, inner=0.5)
BOTH = pytest.mark.parametrize("spiral", [STEADY, PAPER], ids=["steady", "paper"])


def sampled(spiral, until, dt=0.02):
    times = np.arange(0.0, until, dt)
    points = [spiral.at(float(t)) for t in times]
    return times, np.array([w.position for w in points]), np.array([w.velocity for w in points])


@BOTH
def test_velocity_is_the_derivative_of_position(spiral):
    times, position, velocity = sampled(spiral, 0.98 * spiral.duration, 0.001)
    numeric = np.gradient(position, times, axis=0)[1:-1]
    np.testing.assert_allclose(velocity[1:-1], numeric, atol=0.02)


@BOTH
def test_never_faster_than_the_limit_nor_wider_than_the_radius(spiral):
    _, position, velocity = sampled(spiral, 3.0 * spiral.duration)
    assert np.linalg.norm(velocity, axis=1).max() <= 1.5 + 1e-9
    assert np.linalg.norm(position, axis=1).max() <= 8.0 + 1e-9


@BOTH
def test_path_is_continuous_also_where_it_turns_back(spiral):
    _, position, _ = sampled(spiral, 4.2 * spiral.duration)
    assert np.linalg.norm(np.diff(position, axis=0), axis=1).max() <= 1.5 * 0.02 + 1e-6


def test_goes_straight_on_through_the_centre():
    end = 2.0 * STEADY.duration
    before, after = STEADY.at(end - 1e-6), STEADY.at(end + 1e-6)
    np.testing.assert_allclose(before.velocity, after.velocity, atol=1e-3)


def test_arc_length_against_quadrature():
    b, end = 2.0 / math.tau, 8.0 * math.tau / 2.0
    length, _ = integrate.quad(lambda x: b * math.sqrt(1.0 + x * x), 0.0, end)
    assert STEADY.duration * 1.5 == pytest.approx(length, rel=1e-9)


def test_steady_keeps_its_ground_speed():
    _, _, velocity = sampled(STEADY, 2.0 * STEADY.duration)
    np.testing.assert_allclose(np.linalg.norm(velocity, axis=1), 1.5, rtol=1e-9)


def test_paper_form_to_the_letter_where_it_is_slow_enough():
    spiral = SpiralPath.paper(0.1, 0.5, speed=3.0, footprint=2.0, outer=4.0, inner=0.5)
    for t in np.linspace(0.0, 30.0, 31):
        r, angle = 0.5 + 0.1 * t, 0.5 * t
        expected = (r * math.cos(angle), r * math.sin(angle), 0.0)
        np.testing.assert_allclose(spiral.at(float(t)).position, expected, atol=1e-12)


@BOTH
def test_everything_within_the_radius_comes_into_view(spiral):
    """Brute force: each point of the disc is within half a footprint of the path."""
    _, path, _ = sampled(spiral, spiral.duration, 0.05)
    grid = np.stack(np.meshgrid(*[np.arange(-8.0, 8.01, 0.25)] * 2), axis=-1).reshape(-1, 2)
    grid = grid[np.hypot(*grid.T) <= 8.0 - 0.5 * spiral.pitch]
    least = np.full(len(grid), np.inf)
    for p in path:
        least = np.minimum(least, np.hypot(*(grid - p[:2]).T))
    assert least.max() <= 0.5 * spiral.pitch + 0.06


def test_growth_that_would_leave_gaps_is_reduced():
    spiral = SpiralPath.paper(2.0, 0.5, speed=5.0, footprint=3.0, outer=20.0)
    assert spiral.pitch == 3.0


@given(
    st.floats(0.1, 10.0),
    st.floats(0.2, 10.0),
    st.floats(0.1, 50.0),
    st.floats(0.0, 0.9),
    st.floats(0.01, 5.0),
    st.floats(-10.0, 1e5),
)
def test_any_spiral_is_finite_and_within_its_limits(speed, footprint, outer, inner, rate, t):
    spiral = SpiralPath.paper(
        1.0, rate, speed=speed, footprint=footprint, outer=outer, inner=inner * outer
    )
    position, velocity = spiral.at(t)
    assert np.hypot(*position[:2]) <= outer * (1 + 1e-9)
    assert np.hypot(*velocity[:2]) <= speed * (1 + 1e-9)


@pytest.mark.parametrize("change", [{"speed": 0.0}, {"footprint": -1.0}, {"outer": math.nan}])
def test_impossible_spirals_are_refused(change):
    with pytest.raises(ValueError, match="a spiral needs"):
        SpiralPath.steady(**{"speed": 1.0, "footprint": 2.0, "outer": 8.0} | change)
    with pytest.raises(ValueError, match="inner"):
        SpiralPath.steady(1.0, 2.0, outer=3.0, inner=3.0)
