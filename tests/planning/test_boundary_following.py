from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.geometry import norm, vec
from missionkit.planning.boundary_following import follow, shorter_side

GOAL = vec(30, 0, 0)
STILL = np.zeros(3)


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
