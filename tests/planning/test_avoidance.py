"""Flights at 5 m/s past obstacles that a 72-ray scanner sees 12 m away."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest
from flat_world import Box, Cylinder, estimate, fly, scan
from hypothesis import given, settings
from hypothesis import strategies as st

from missionkit.geometry import norm, vec
from missionkit.planning.boundary_following import BoundaryProgress
from missionkit.planning.obstacle_weights import ObstacleWeight, factors_at
from missionkit.planning.potential_field import BLIND_SPEED, PotentialField
from missionkit.planning.scan_memory import FieldMemory

FIELD = PotentialField()
GOAL = vec(40, 0, -3)
CRUISE = vec(5, 0, 0)
SAFE = FIELD.body_radius + 0.3  # m, from the vehicle's centre

COURSES = {
    "cylinder straight ahead": (Cylinder(20, 0, 1.0),),
    "cylinder grazing": (Cylinder(20, 1.5, 1.0),),
    "large cylinder": (Cylinder(20, 0, 3.0),),
    "wall": (Box((20, -3), (21, 3)),),
    "wall off centre": (Box((20, -1), (21, 5)),),
    "wall before the goal": (Box((36, -3), (38, 3)),),
    "u": (Box((20, -3), (20.5, 3)), Box((17, -3), (20, -2.5)), Box((17, 2.5), (20, 3))),
    "deep u": (Box((20, -4), (20.5, 4)), Box((14, -4), (20, -3.5)), Box((14, 3.5), (20, 4))),
    "gate": (Box((20, -6), (20.5, -1.5)), Box((20, 1.5), (20.5, 6))),
    "two cylinders": (Cylinder(20, 0, 1.0), Cylinder(20, 3, 1.0)),
    "row of trees": tuple(Cylinder(8 + 6 * i, (-1) ** i, 0.6) for i in range(5)),
}


@pytest.mark.parametrize("name", COURSES)
def test_reaches_the_goal_clear_of_obstacles(name):
    flight = fly(FIELD, COURSES[name], GOAL)
    assert flight.arrived < 30.0
    assert flight.clearance > SAFE


def test_a_goal_near_an_obstacle_is_reached():
    flight = fly(FIELD, (Box((41.2, -3), (42, 3)),), GOAL)
    assert flight.arrived < 15.0


def test_without_escape_it_stops_before_the_wall_and_stays():
    flight = fly(PotentialField(patience=1e6), COURSES["wall"], GOAL, until=20.0)
    assert math.isinf(flight.arrived)
    assert flight.clearance > SAFE
    assert norm(flight.path[-1] - flight.path[-20]) < 0.05


def test_brake_alone_never_collides():
    """Straight at a wall, ignoring all but the brake."""
    walls = (Box((20, -8), (21, 8)),)
    p, v, memory, pipe = vec(0, 0.3, -3), np.zeros(3), FIELD.begin(), [np.zeros(3)] * 2
    for k in range(300):
        seen = estimate(k * 0.05, p, v, scan(p, walls))
        _, memory = FIELD.step(memory, seen, GOAL, CRUISE)
        pipe.append(FIELD.brake(memory, seen, CRUISE))
        pull = (pipe.pop(0) - v) / 0.3
        v = v + 0.05 * pull * min(1.0, 3.0 / max(norm(pull), 1e-9))
        p = p + 0.05 * v
    assert 18.0 < p[0] < 20.0 - FIELD.body_radius - 0.5 * FIELD.clearance
    assert norm(v) < 0.02


def test_an_edge_may_stand_between_two_rays():
    edge = np.array([[5.0, FIELD.body_radius + FIELD.clearance + 0.1, -3.0]])
    seen = estimate(0.0, vec(0, 0, -3), CRUISE, edge)
    for field, slows in ((FIELD, True), (PotentialField(ray_deg=0.0), False)):
        _, memory = field.step(field.begin(), seen, GOAL, CRUISE)
        assert bool(field.brake(memory, seen, CRUISE)[0] < 5.0) is slows


@pytest.mark.parametrize(("obstacle", "goes_on"), [((11.5, 0.0), True), ((8.5, 0.0), False)])
def test_escape_ends_nearer_to_the_goal_and_only_in_the_open(obstacle, goes_on):
    points = np.array([[*obstacle, -3.0]])
    seen = estimate(1.0, vec(10, 0, -3), np.zeros(3), points)
    memory = FieldMemory(goal=(40.0, 0.0, -3.0), progress=BoundaryProgress(30.5, 0.5, side=1))
    _, after = FIELD.step(memory, seen, GOAL, CRUISE)
    assert after.progress == (memory.progress if goes_on else BoundaryProgress(30.0, 1.0))
    farther = memory._replace(progress=BoundaryProgress(29.5, 0.5, side=1))
    assert FIELD.step(farther, seen, GOAL, CRUISE)[1].progress.side == 1


def test_potential_falls_along_the_field():
    points = np.array([[2.0, 0.3, 0.0]])
    field = PotentialField(gain_z=1.5)
    p, goal = vec(0, 0, 0), vec(5, 0, 0)
    step = field.attraction(p, goal)
    lower = field.potential(p + 1e-3 * step, goal, points)
    assert lower < field.potential(p, goal, points)


def test_far_obstacles_do_nothing():
    seen = estimate(0.0, vec(0, 0, -3), CRUISE, np.array([[30.0, 0.0, -3.0]]))
    push, _ = FIELD.step(FIELD.begin(), seen, GOAL, CRUISE)
    assert not push.any()


def test_a_scan_counts_until_it_is_too_old():
    seen = estimate(0.0, vec(0, 0, -3), CRUISE, np.array([[2.0, 0.0, -3.0]]))
    push, memory = FIELD.step(FIELD.begin(), seen, GOAL, CRUISE)
    assert push[0] < 0.0
    push, memory = FIELD.step(memory, estimate(0.4, seen.position, CRUISE, None), GOAL, CRUISE)
    assert push[0] < 0.0
    push, _ = FIELD.step(memory, estimate(0.6, seen.position, CRUISE, None), GOAL, CRUISE)
    np.testing.assert_allclose(CRUISE + push, (BLIND_SPEED, 0.0, 0.0))


def test_a_column_is_avoided_level_and_what_is_far_below_is_not():
    above = estimate(0.0, vec(0, 0, -3), np.zeros(3), np.array([[1.2, 0.0, -2.2]]))
    push, _ = FIELD.step(FIELD.begin(), above, GOAL, np.zeros(3))
    assert push[0] < 0.0
    assert push[2] == 0.0
    high = estimate(0.0, vec(0, 0, -8), np.zeros(3), np.array([[1.2, 0.0, -2.2]]))
    assert not FIELD.step(FIELD.begin(), high, GOAL, np.zeros(3))[0].any()


def test_a_broken_point_does_not_hide_the_others():
    points = np.array([[math.nan, 0.0, -3.0], [2.0, 0.0, -3.0]])
    seen = estimate(0.0, vec(0, 0, -3), CRUISE, points)
    clean = estimate(0.0, vec(0, 0, -3), CRUISE, points[1:])
    push, _ = FIELD.step(FIELD.begin(), seen, GOAL, CRUISE)
    np.testing.assert_array_equal(push, FIELD.step(FIELD.begin(), clean, GOAL, CRUISE)[0])


def test_memory_can_be_saved_and_the_step_is_pure():
    p, memory = vec(17.8, 0.1, -3), FIELD.begin()
    for k in range(40):
        seen = estimate(k * 0.05, p, np.zeros(3), scan(p, COURSES["wall"]))
        _, memory = FIELD.step(memory, seen, GOAL, CRUISE)
    assert memory.progress.side == -1
    saved = pickle.loads(pickle.dumps(memory))  # noqa: S301
    one, _ = FIELD.step(memory, seen, GOAL, CRUISE)
    two, _ = FIELD.step(saved, seen, GOAL, CRUISE)
    assert one.tobytes() == two.tobytes()


anything = st.floats(allow_nan=True, allow_infinity=True)
triples = st.tuples(anything, anything, anything).map(np.array)
near = st.floats(-4.0, 4.0)


@settings(max_examples=60)
@given(triples, triples, triples, triples, st.lists(triples, max_size=5))
def test_the_repulsion_is_finite_for_any_input(position, velocity, goal, wanted, points):
    seen = estimate(0.0, position, velocity, np.array(points).reshape(-1, 3))
    with np.errstate(all="ignore"):
        push, _ = FIELD.step(FIELD.begin(), seen, goal, wanted)
    assert np.isfinite(push).all()


@given(st.lists(st.tuples(near, near, near), min_size=1, max_size=20))
def test_repulsion_is_clamped(points):
    seen = estimate(0.0, np.zeros(3), np.zeros(3), np.array(points))
    push, _ = FIELD.step(FIELD.begin(), seen, GOAL, np.zeros(3))
    assert norm(push) <= FIELD.top_speed + 1e-9


def test_an_obstacle_that_weighs_more_is_passed_farther_away_and_others_are_not():
    trees = (Cylinder(20, 1.9, 0.6), Cylinder(30, 60.0, 0.6))
    here = {"polygon": ((18, 0.5), (22, 0.5), (22, 3.5), (18, 3.5)), "factor": 6.0}
    there = {**here, "polygon": ((28, 58), (32, 58), (32, 62), (28, 62))}
    usual, heavy, elsewhere = (
        fly(PotentialField(weights=weights), trees, GOAL) for weights in ((), (here,), (there,))
    )
    assert heavy.clearance > usual.clearance + 0.2
    assert heavy.arrived < 30.0
    assert elsewhere.clearance == usual.clearance


def test_the_largest_weight_of_overlapping_polygons_counts():
    square = ((0, 0), (4, 0), (4, 4), (0, 4))
    weights = [ObstacleWeight(polygon=square, factor=0.5)]
    weights.append(ObstacleWeight(polygon=tuple((n + 2, e) for n, e in square), factor=3.0))
    points = np.array([[1.0, 1.0, 0.0], [3.0, 1.0, -2.0], [5.0, 3.0, 0.0], [9.0, 1.0, 0.0]])
    assert factors_at(points, weights).tolist() == [0.5, 3.0, 3.0, 1.0]
