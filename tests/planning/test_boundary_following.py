from __future__ import annotations

import math

import numpy as np
import pytest
from flat_world import estimate

from missionkit.geometry import norm, vec
from missionkit.planning.boundary_escape import EscapeLimits, progressed
from missionkit.planning.boundary_following import BoundaryProgress, follow, shorter_side
from missionkit.planning.obstacle_braking import NearbyObstacles, Stopping
from missionkit.planning.scan_memory import FieldMemory

GOAL = vec(30, 0, 0)
STILL = np.zeros(3)
HOW = EscapeLimits(0.3, 0.3, 40.0, 1.3, 3.0, Stopping(0.75, 2.0, 0.7))


def wall(west, east, north=2.0):
    """Points every 5 degrees on a wall from west to east, ahead of a vehicle at the origin."""
    bearings = np.arange(math.atan2(west, north), math.atan2(east, north), math.radians(5.0))
    points = np.column_stack([np.full(len(bearings), north), north * np.tan(bearings)])
    return -np.column_stack([points, np.zeros(len(points))])


@pytest.mark.parametrize(("west", "east", "side"), [(-1.0, 5.0, 1), (-5.0, 1.0, -1)])
def test_takes_the_shorter_way_round(west, east, side):
    """+1 is clockwise round the obstacle: to the west of one in the north."""
    assert shorter_side(wall(west, east), GOAL, STILL, 1.3) == side
    assert side * follow(vec(-2, 0, 0), 1.0, 1.0, 2.0, side)[1] < 0.0


@pytest.mark.parametrize(("drift", "side"), [(0.5, -1), (-0.5, 1)])
def test_of_equal_ways_the_one_under_way(drift, side):
    assert shorter_side(wall(-3.0, 3.0), GOAL, vec(0, drift, 0), 1.3) == side


@pytest.mark.parametrize(("passage", "side"), [(0.5, -1), (1.8, 1)])
def test_a_gap_too_narrow_for_the_vehicle_is_not_a_path(passage, side):
    both = np.vstack([wall(-3.0, 0.2), wall(1.2, 6.0)])
    assert shorter_side(both, GOAL, STILL, passage) == side


@pytest.mark.parametrize("side", [1, -1])
def test_following_circles_a_point_at_the_kept_distance(side):
    p, swept = vec(-2.5, 0, 0), 0.0
    for _ in range(400):
        v = follow(p, norm(p), 1.0, 2.0, side)
        assert norm(v) == pytest.approx(2.0)
        q = p + 0.02 * v
        swept += math.atan2(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1])
        p = q
    assert norm(p) == pytest.approx(1.0, abs=0.05)
    assert side * swept > 2.0 * math.pi


def test_on_top_of_the_point_it_stands_still():
    assert not follow(vec(0, 0, 1), 0.0, 1.0, 2.0, 1).any()


def progress(last, distance, now, *, hindered=True):
    """Return how the way to `GOAL` goes on from 2 m beside a post, `distance` (m) from the goal."""
    here = GOAL - vec(distance, 0, 0)
    away = vec(0, 2.0, 0)[None]
    seen = estimate(now, here, STILL, None)
    around = NearbyObstacles(away, np.vecdot(away, away))
    return progressed(last, seen, GOAL, around, HOW, hindered=hindered)


def test_an_escape_ends_a_step_nearer_to_the_goal_than_it_began_and_no_sooner():
    escaping = BoundaryProgress(best=10.0, since=1.0, side=1)
    assert progress(escaping, 10.2, 2.0) == escaping
    assert progress(escaping, 9.8, 2.0) == escaping
    assert progress(escaping, 9.6, 2.0) == BoundaryProgress(pytest.approx(9.6), 2.0)
    assert progress(escaping, 12.0, 1.0 + HOW.longest) == BoundaryProgress(12.0, 41.0)


def test_patience_counts_only_while_obstacles_hinder():
    waiting = BoundaryProgress(best=10.0, since=1.0)
    free = progress(waiting, 10.2, 5.0, hindered=False)
    assert free == BoundaryProgress(10.0, 5.0)
    assert progress(free, 10.2, 5.2).side == 0
    assert progress(free, 10.2, 5.4).side != 0


def test_when_nothing_is_near_the_best_distance_stays_and_the_escape_is_over():
    memory = FieldMemory(progress=BoundaryProgress(best=4.0, since=2.0, side=1))
    assert memory.clear().progress == BoundaryProgress(best=4.0)
