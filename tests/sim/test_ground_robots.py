"""Each rule of the ground robots' firmware, as a truth about their paths."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from missionkit.ground_robot import GroundRobot
from missionkit.sim.ground_robots import (
    EAST,
    HEADING,
    NORTH,
    REVERSAL_IN,
    SPIN_LEFT,
    advance,
    bump,
    placed,
    random_offsets,
    touch,
)

ROBOT = GroundRobot()
SPIN = ROBOT.spin_time
NO_TURNS = np.zeros((1, 200))


def one(phase: float = 20.0, *, obstacle: bool = False):
    return placed(np.zeros((1, 2)), np.zeros(1), np.array([phase]), ROBOT, obstacles=int(obstacle))


def after(robots, *steps: float, offsets=NO_TURNS):
    for dt in steps:
        advance(robots, offsets, ROBOT, dt)
    return robots[0]


def heading(robots) -> float:
    return math.degrees(robots[0, HEADING])


@settings(deadline=None)  # the first example compiles
@given(phase=st.floats(0.0, 20.0), seed=st.integers(0, 99), cuts=st.lists(st.floats(0.0, 60.0)))
def test_a_path_does_not_depend_on_the_steps_it_is_computed_in(phase, seed, cuts):
    offsets = random_offsets(np.random.default_rng(seed), 1, 60.0, ROBOT)
    times = sorted((0.0, *cuts, 60.0))
    whole, parts = one(phase), one(phase)
    advance(whole, offsets, ROBOT, 60.0)
    after(parts, *np.diff(times), offsets=offsets)
    assert parts[:, :3] == pytest.approx(whole[:, :3], abs=1e-6)


def test_it_reverses_every_20_s_and_by_exactly_half_a_turn():
    robots = one(phase=7.0)
    assert after(robots, 7.0)[NORTH] == pytest.approx(7.0 * ROBOT.speed)
    before = robots[0, :2].copy()
    assert after(robots, SPIN)[:2] == pytest.approx(before)
    assert heading(robots) == pytest.approx(180.0)
    after(robots, 20.0 - SPIN)
    assert (heading(robots), robots[0, SPIN_LEFT]) == pytest.approx((180.0, 0.0))
    after(robots, SPIN)
    assert heading(robots) == pytest.approx(360.0)


@pytest.mark.parametrize(("hit", "turn"), [(bump, 180.0), (touch, 45.0)])
def test_a_bump_and_a_touch_turn_it_and_leave_its_clock_alone(hit, turn):
    robots, other = one(), one()
    after(robots, 3.0)
    assert hit(robots[0], ROBOT)
    after(robots, SPIN)
    assert heading(robots) == pytest.approx(turn)
    after(other, 3.0, SPIN)
    assert robots[0, REVERSAL_IN] == pytest.approx(other[0, REVERSAL_IN])


@pytest.mark.parametrize("hit", [bump, touch])
def test_neither_counts_during_a_spin(hit):
    robots = one(phase=0.0)
    after(robots, 1.0)
    assert not hit(robots[0], ROBOT)
    after(robots, SPIN)
    assert heading(robots) == pytest.approx(180.0)


def test_a_bump_just_before_a_reversal_turns_it_all_the_way_round():
    robots = one(phase=5.0)
    after(robots, 4.9)
    bump(robots[0], ROBOT)
    after(robots, 2.0 * SPIN)
    assert heading(robots) == pytest.approx(360.0)
    after(robots, 20.1 - 2.0 * SPIN)  # the clock went on from 5 s, when the reversal was due
    assert robots[0, SPIN_LEFT] == pytest.approx(SPIN, abs=1e-9)


def test_random_turns_come_every_5_s_within_12_degrees():
    rng = np.random.default_rng(0)
    headings = []
    for _ in range(400):
        robots = one(phase=19.0)
        after(robots, 18.9, offsets=random_offsets(rng, 1, 20.0, ROBOT))
        headings.append(heading(robots))
    turns = np.array(headings)  # at 4, 9 and 14 s
    limit = math.degrees(2.0 * 0.032 * 0.85 / 0.258)
    assert limit == pytest.approx(12.1, abs=0.05)
    assert np.abs(turns).max() < 3.0 * limit
    assert turns.std() == pytest.approx(limit, rel=0.1)  # sqrt(3) times that of a uniform one
    assert math.radians(turns.std()) ** 2 == pytest.approx(15.0 * ROBOT.turn_variance, rel=0.2)


def test_a_turn_lasts_085_s_at_a_constant_rate():
    offsets = np.full((1, 9), 0.032)
    robots = one(phase=20.0)
    robots[0, 5] = 1.0  # s until the turn
    rates = np.diff([after(robots, 0.05, offsets=offsets)[HEADING] for _ in range(60)]) / 0.05
    turning = np.abs(rates) > 1e-9
    assert turning.sum() * 0.05 == pytest.approx(0.85, abs=0.051)
    assert rates.max() == pytest.approx(2.0 * 0.032 / 0.258)


def test_it_never_drives_faster_or_slower_than_its_speed():
    offsets = random_offsets(np.random.default_rng(3), 1, 600.0, ROBOT)
    robots = one(phase=11.0)
    places = np.array([after(robots, 0.01, offsets=offsets)[:2].copy() for _ in range(6000)])
    speeds = np.hypot(*np.diff(places, axis=0).T) / 0.01
    standing = speeds < 1e-9
    assert standing.mean() == pytest.approx(3.0 * SPIN / 60.0, abs=0.002)
    moving = speeds[~standing]
    assert np.median(moving) == pytest.approx(ROBOT.speed, rel=1e-5)
    assert moving.max() < ROBOT.speed * (1.0 + 1e-9)


def test_an_obstacle_robot_circles_clockwise_whatever_happens():
    robots = one(phase=1.0, obstacle=True)
    assert not bump(robots[0], ROBOT)
    assert not touch(robots[0], ROBOT)
    quarter = 0.25 * 2.0 * math.pi * ROBOT.circle_radius / ROBOT.speed
    state = after(robots, *[quarter / 50.0] * 50)
    assert state[[NORTH, EAST]] == pytest.approx([5.0, 5.0])
    assert heading(robots) == pytest.approx(90.0)
