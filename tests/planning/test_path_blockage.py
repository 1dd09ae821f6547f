"""Whether a path is blocked, against numpy over the same points and pieces."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from missionkit.messages import Occupancy
from missionkit.planning.path_blockage import (
    NEARER,
    backed_off,
    in_the_way,
    walled,
)

NAN = math.nan


def gaps(points, start, end):
    """Return the distance from every point to a piece, level."""
    start, way = np.array(start), np.subtract(end, start)
    share = np.clip((points[:, :2] - start) @ way / (way @ way), 0.0, 1.0)
    return np.linalg.norm(points[:, :2] - start - share[:, None] * way, axis=1)


@pytest.mark.parametrize("seed", range(20))
def test_what_is_near_is_in_the_way_unless_the_vehicle_is_as_near_to_something(seed):
    rng = np.random.default_rng(seed)
    answers = set()
    for _ in range(50):
        points, here = rng.uniform(-3.0, 3.0, (5, 3)), tuple(rng.uniform(-3.0, 3.0, 2))
        spots = [tuple(spot) for spot in rng.uniform(-3.0, 3.0, (4, 2))]
        pieces = list(pairwise(spots))
        least = min(0.5, np.linalg.norm(points[:, :2] - here, axis=1).min() - NEARER)
        expected = any((gaps(points, *piece) < least).any() for piece in pieces)
        assert in_the_way(points, pieces, 0.5, here) == expected
        answers.add(expected)
    assert answers == {True, False}


def test_a_path_that_leads_nearer_within_the_noise_is_free():
    beside = np.array([[0.0, 0.30, 0.0]])
    by = lambda nearer: [((0.0, nearer), (1.0, nearer))]  # noqa: E731
    assert not in_the_way(beside, by(0.02), 0.5, (0.0, 0.0))
    assert in_the_way(beside, by(0.08), 0.5, (0.0, 0.0))


def test_a_path_along_a_wall_that_the_vehicle_is_too_near_to_is_free():
    """It comes nearer to each part of the wall that it passes, and never nearer to the wall."""
    wall = np.array([(0.7, east, 0.0) for east in np.arange(-2.0, 2.0, 0.1)])
    assert not in_the_way(wall, [((0.0, 0.0), (0.0, 1.5))], 1.0, (0.0, 0.0))
    assert in_the_way(wall, [((0.0, 0.0), (0.1, 1.5))], 1.0, (0.0, 0.0))
    assert in_the_way(wall, [((0.0, 0.0), (0.0, 1.5))], 1.0, (-0.4, 0.0))


def test_backing_off_keeps_the_distance_where_there_is_room_behind():
    wall = np.array([(0.7, east, 0.0) for east in np.arange(-2.0, 2.05, 0.1)])
    spot = backed_off((0.0, 0.0), wall, 0.9)
    assert spot == pytest.approx((-0.2, 0.0))
    assert backed_off(spot, wall, 0.9) == pytest.approx(spot)
    behind = np.array([(-0.75, 0.0, 0.0), (NAN, 0.0, 0.0)])
    assert backed_off((0.0, 0.0), np.concatenate((wall, behind)), 0.9) == (0.0, 0.0)
    assert backed_off((0.0, 0.0), np.empty((0, 3)), 0.9) == (0.0, 0.0)


def test_nothing_sensed_or_nothing_ahead_is_free():
    assert not in_the_way(np.empty((0, 3)), [((0.0, 0.0), (1.0, 0.0))], 1.0, (0.0, 0.0))
    assert not in_the_way(np.zeros((1, 3)), [], 1.0, (2.0, 0.0))


def test_points_that_are_not_finite_are_not_in_the_way():
    points = np.array([[NAN, 0.0, 0.0], [0.5, NAN, 0.0], [math.inf, 0.0, 0.0]])
    assert not in_the_way(points, [((0.0, 0.0), (1.0, 0.0))], 1.0, (0.0, 3.0))


@pytest.mark.parametrize(
    ("start", "end", "expected"),
    [
        ((0.5, 0.5), (0.5, 3.5), False),
        ((0.5, 0.5), (3.5, 0.5), True),  # through the wall
        ((0.5, 0.5), (-0.5, 0.5), True),  # off the map
        ((0.5, 4.5), (0.5, 0.5), True),
        ((0.5, 0.5), (NAN, 0.5), True),
    ],
)
def test_a_wall_and_the_edge_of_the_map_block(start, end, expected):
    costs = np.ones((4, 4))
    costs[2, :2] = np.inf
    known = Occupancy(costs, 1.0, (0.0, 0.0))
    assert walled(known, [((0.5, 0.5), (0.6, 0.5)), (start, end)]) == expected


def test_no_path_meets_no_wall():
    assert not walled(Occupancy(np.ones((2, 2)), 1.0, (0.0, 0.0)), [])
