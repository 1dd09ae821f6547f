"""Closing a level distance and a height: the times against an integration of the profiles."""

from __future__ import annotations

import pytest

from missionkit.control.landing_profile import (
    Closing,
    Descent,
    closing_speed,
    closing_time,
    descent_time,
    height_before,
)

CLOSING = Closing(gain=2.0, braking=3.0, top=5.0)
DESCENT = Descent(rate=1.5, slowing=2.0, touch_down=0.4)
DT = 1e-4


@pytest.mark.parametrize("distance", [0.05, 0.5, 1.0, 4.0, 12.0])
def test_the_time_to_the_goal_is_that_of_the_profile(distance):
    left, time = distance, 0.0
    while left > 0.03:
        left -= DT * closing_speed(CLOSING, left)[0]
        time += DT
    assert closing_time(CLOSING, distance, 0.0, 0.03) == pytest.approx(time, abs=0.01)


def test_the_slope_is_how_the_speed_falls_with_the_distance():
    for distance in (0.1, 0.6, 2.0, 20.0):
        speed, slope = closing_speed(CLOSING, distance)
        rise = closing_speed(CLOSING, distance + 1e-6)[0] - speed
        assert slope == pytest.approx(rise / 1e-6, abs=1e-3)


def test_one_that_is_too_fast_over_its_goal_has_not_arrived():
    assert closing_time(CLOSING, 0.01, 0.0, 0.03) == 0.0
    assert closing_time(CLOSING, 0.01, 1.0, 0.03) > 0.5


@pytest.mark.parametrize("height", [0.0, 0.1, 0.5, 2.0, 6.0])
def test_height_and_time_of_a_descent_are_inverse(height):
    time = descent_time(DESCENT, height)
    assert height_before(DESCENT, time, DESCENT.rate).height == pytest.approx(height)


def test_it_begins_earlier_where_it_does_not_sink_yet():
    waiting, sinking = height_before(DESCENT, 2.0, 0.0), height_before(DESCENT, 2.0, 1.5)
    # gathering speed at 2 m/s² costs d²/(2 c) = 0.5625 m
    assert sinking.height - waiting.height == pytest.approx(0.5625)
