"""Plans round obstacles that stand, move, or are straight ahead."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.planning.ddp.flight_plan import kept, plan_flight
from missionkit.planning.ddp.point_mass import Flight, MotionLimits, Obstacle

REST = np.zeros(6)
AHEAD = np.array([5.0, 0.0, -1.0, 0.0, 0.0, 0.0])


def nearest(plan, obstacle, dt=0.1):
    times = dt * np.arange(len(plan.states))[:, None]
    centres = np.array(obstacle.place) + times * np.array(obstacle.velocity)
    return float(np.hypot(*(plan.states[:, :2] - centres).T).min())


def test_straight_at_the_middle_of_an_obstacle_it_passes_beside():
    """From there the penalty has no slope to either side."""
    obstacle = Obstacle((2.5, 0.0), (0.0, 0.0), 0.6)
    plan = plan_flight(Flight(AHEAD, obstacles=(obstacle,)), REST)
    assert kept(plan)
    assert nearest(plan, obstacle) >= 0.57
    assert math.dist(plan.states[-1, :3], AHEAD[:3]) < 0.2


def test_it_waits_for_what_crosses_or_passes_behind_it():
    obstacle = Obstacle((2.5, -1.0), (0.0, 0.5), 0.6)
    plan = plan_flight(Flight(AHEAD, obstacles=(obstacle,)), REST)
    assert kept(plan)
    assert nearest(plan, obstacle) >= 0.57
    still = plan_flight(Flight(AHEAD, obstacles=(obstacle._replace(velocity=(0.0, 0.0)),)), REST)
    assert nearest(still, obstacle) < 0.57  # for where it will be, not for where it is


def test_many_obstacles():
    """In random fields, one obstacle of a field in four straight ahead, there is always a plan."""
    rng = np.random.default_rng(21)
    for turn in range(30):
        places = rng.uniform((1.2, -1.2), (4.0, 1.2), (3, 2))
        if turn % 4 == 0:
            places[0, 1] = 0.0
        speeds, radii = 0.2 * rng.normal(size=(3, 2)), rng.uniform(0.4, 0.7, 3)
        obstacles = tuple(
            Obstacle(tuple(p), tuple(v), r) for p, v, r in zip(places, speeds, radii, strict=True)
        )
        plan = plan_flight(Flight(AHEAD, obstacles=obstacles), REST)
        assert kept(plan), turn
        assert all(nearest(plan, it) >= it.radius - 0.031 for it in obstacles)


def test_a_later_plan_goes_on_with_the_same_side():
    obstacle = Obstacle((2.5, 0.0), (0.0, 0.0), 0.6)
    flight = Flight(AHEAD, obstacles=(obstacle,))
    plan = plan_flight(flight, REST)
    side = np.sign(plan.states[15, 1])
    for _ in range(10):
        plan = plan_flight(flight, plan.states[1] + 0.005, plan, 1)
        assert kept(plan)
        assert np.sign(plan.states[5, 1]) == side


def test_inside_an_obstacle_it_says_so():
    plan = plan_flight(Flight(AHEAD, obstacles=(Obstacle((0.1, 0.0), (0.0, 0.0), 0.6),)), REST)
    assert not kept(plan)
    assert np.isfinite(plan.states).all()
    assert np.isfinite(plan.controls).all()


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_numbers_that_are_not_finite_are_refused(bad):
    with pytest.raises(ValueError, match="target"):
        plan_flight(Flight(np.array([bad, 0, 0, 0, 0, 0])), REST)
    with pytest.raises(ValueError, match="obstacles"):
        plan_flight(Flight(AHEAD, obstacles=(Obstacle((bad, 0.0), (0.0, 0.0), 0.6),)), REST)
    with pytest.raises(ValueError, match="limits"):
        plan_flight(Flight(AHEAD, MotionLimits(speed=bad)), REST)
    with pytest.raises(ValueError, match="finite"):
        plan_flight(Flight(AHEAD), np.full(6, bad))
