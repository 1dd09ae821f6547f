"""No faster than what is seen allows, and braking as the last word."""

from __future__ import annotations

import math

import numpy as np
import pytest
from flat_world import RANGE, Box, estimate, fly

from missionkit.geometry import norm, vec
from missionkit.messages import Guidance
from missionkit.planning.approach_distance import LEAST_GAP
from missionkit.planning.obstacle_braking import (
    NearbyObstacles,
    Stopping,
    backed_off,
    stopping_distance,
)
from missionkit.planning.potential_field import BLIND_SPEED, PotentialField

FIELD = PotentialField()
GOAL, HERE = vec(60, 0, -3), vec(0, 0, -3)
NOTHING = np.empty((0, 3))


def looked(field, points, *, now=0.0, position=HERE, velocity=HERE * 0.0):
    seen = estimate(now, position, velocity, points)
    return field.noted(field.begin(), seen), seen


@pytest.mark.parametrize("speed", [6.0, 7.0, 8.0])
def test_it_stops_before_a_wall_at_any_requested_speed(speed):
    walls = (Box((30, -8), (31, 8)),)
    flight = fly(FIELD, walls, GOAL, speed=speed, until=30.0)
    fastest = np.linalg.norm(np.diff(flight.path, axis=0), axis=1).max() / 0.05
    assert flight.clearance > FIELD.body_radius + 0.25
    assert fastest == pytest.approx(FIELD.admissible(RANGE), abs=0.15)


def test_the_fastest_speed_stops_within_what_is_seen():
    how = Stopping(FIELD.body_radius + FIELD.clearance, FIELD.deceleration, FIELD.reaction)
    assert stopping_distance(FIELD.admissible(12.0), how) + how.width == pytest.approx(12.0)
    assert FIELD.admissible(12.0) == pytest.approx(5.45, abs=0.01)
    assert FIELD.admissible(math.inf) == math.inf


def test_sight_is_what_the_scanner_says_or_less():
    memory, _ = looked(FIELD, NOTHING)
    assert memory.sight == RANGE
    assert looked(PotentialField(sight=6.0), NOTHING)[0].sight == 6.0
    assert looked(PotentialField(sight=60.0), NOTHING)[0].sight == RANGE


def test_a_scanner_that_never_reported_limits_nothing():
    memory, seen = looked(FIELD, None)
    np.testing.assert_array_equal(FIELD.brake(memory, seen, vec(9, 0, 1)), (9, 0, 1))
    assert not FIELD.blind(memory, 99.0)


def test_a_silent_scanner_leaves_what_holds_a_place_and_the_climb():
    memory, _ = looked(FIELD, NOTHING)
    later = estimate(0.6, HERE, HERE * 0.0, None)
    np.testing.assert_allclose(FIELD.brake(memory, later, vec(3, 4, -1)), (0.3, 0.4, -1.0))
    assert norm(FIELD.brake(memory, later, vec(3, 4, 0))) == pytest.approx(BLIND_SPEED)


TRUNK = np.array([[0.5, 0.0, -3.0]])


@pytest.mark.parametrize(("asked", "free"), [(0.9, False), (0.6, True)])
def test_what_is_worked_on_may_be_approached_as_far_as_the_goal_asks(asked, free):
    """The marker hangs 0.1 m before the surface; another tree stands on the other side."""
    work = Guidance(vec(0.5 - asked, 0, -3), 1.0, avoid=False, work=vec(0.4, 0, -3))
    memory, seen = looked(FIELD, np.vstack([TRUNK, [[-2.5, 0.0, -3.0]]]))
    ahead = FIELD.brake(memory, seen, vec(0.05, 0, 0), work)
    assert bool(ahead[0] > 0.0) is free
    assert FIELD.brake(memory, seen, vec(0.05, 0, 0))[0] < 0.0
    elsewhere = work._replace(work=vec(9, 9, -3))
    assert FIELD.brake(memory, seen, vec(0.05, 0, 0), elsewhere)[0] < 0.0


def test_a_work_never_comes_nearer_than_the_body_allows():
    """A marker believed behind the surface asks for a goal inside it."""
    work = Guidance(vec(0.5, 0, -3), 1.0, avoid=False, work=vec(0.6, 0, -3))
    near = vec(0.5 - FIELD.body_radius - LEAST_GAP + 0.02, 0, -3)
    memory, seen = looked(FIELD, TRUNK, position=near)
    assert FIELD.brake(memory, seen, vec(0.5, 0, 0), work)[0] < 0.0


def test_what_pushes_the_vehicle_in_is_answered_the_harder_the_further_in_it_is():
    how = Stopping(0.75, 2.0, 0.7)
    pushed = [
        backed_off(
            vec(0, 0.2, 0), NearbyObstacles(np.array([[-gap, 0, 0]]), np.array([gap**2])), how, 3.0
        )
        for gap in (0.8, 0.7, 0.5)
    ]
    np.testing.assert_allclose([v[0] for v in pushed], (0.0, -0.15, -0.75))
    assert {v[1] for v in pushed} == {0.2}


@pytest.mark.parametrize(("north", "sent"), [(1.0, -0.75), (-0.5, -0.75), (-2.0, -2.0)])
def test_what_is_flown_away_already_is_not_added_to(north, sent):
    how, gap = Stopping(0.75, 2.0, 0.7), 0.5
    near = NearbyObstacles(np.array([[-gap, 0, 0]]), np.array([gap**2]))
    np.testing.assert_allclose(backed_off(vec(north, 0.2, 0), near, how, 3.0), (sent, 0.2, 0))


def test_the_last_command_brakes_harder_than_planned():
    points = np.array([[5.0, 0.0, -3.0]])
    memory, seen = looked(FIELD, points, velocity=vec(4, 0, 0))
    push, _ = FIELD.step(memory, seen, GOAL, vec(4, 0, 0))
    assert FIELD.brake(memory, seen, vec(4, 0, 0))[0] < 4.0 + push[0] - 1.0
