"""Paths in metres over maps with walls: how far off they stay, how they end, why there is none."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

from missionkit.messages import Occupancy
from missionkit.planning.map_inflation import inflated, margin
from missionkit.planning.path_smoothing import line_cost
from missionkit.planning.polygon_cells import drawn
from missionkit.planning.route_planning import (
    NoRouteError,
    Way,
    length_of,
    plan,
)

AREA = ((-2.0, -2.0), (10.0, 8.0))
WALLS = [
    [(2.4, -2.0), (2.6, -2.0), (2.6, 3.5), (2.4, 3.5)],
    [(5.4, 2.0), (5.6, 2.0), (5.6, 8.0), (5.4, 8.0)],
]
ROOM = drawn(AREA, 0.1, WALLS)
START, GOAL = (0.03, -0.02), (8.0, 6.0)


def gaps(route, walls=WALLS):
    """The distance to the walls, every centimetre of the path."""
    spots = np.array(route.spots)
    at = []
    for a, b in pairwise(spots):
        count = max(2, int(np.hypot(*(b - a)) / 0.01))
        at.append(a + np.linspace(0.0, 1.0, count)[:, None] * (b - a))
    points = np.concatenate(at)
    found = np.full(len(points), np.inf)
    for wall in walls:
        low, high = np.min(wall, axis=0), np.max(wall, axis=0)
        off = np.maximum(np.maximum(low - points, points - high), 0.0)
        found = np.minimum(found, np.hypot(*off.T))
    return found


@pytest.mark.parametrize("way", [Way(0.6, 4), Way(0.6, 8), Way(0.6, 8, "euclidean")])
def test_a_path_keeps_its_distance_and_ends_where_it_should(way):
    route = plan(ROOM, START, GOAL, way)
    assert route.spots[0] == pytest.approx(START)
    assert route.spots[-1] == pytest.approx(GOAL)
    assert gaps(route).min() > 0.59
    assert route.length == pytest.approx(length_of(route.spots))


def test_diagonals_are_shorter_and_lines_of_sight_shorter_still():
    classical, modified = (plan(ROOM, START, GOAL, Way(0.6, n)) for n in (4, 8))
    smooth = plan(ROOM, START, GOAL, Way(0.6, 8, smooth=True))
    assert smooth.length < modified.length - 0.5 < classical.length - 4.0
    assert len(smooth.spots) < len(modified.spots)
    assert gaps(smooth).min() > 0.6 - 0.1 / math.sqrt(2.0)


def test_the_margin_adds_the_uncertainties():
    assert margin(0.5, 0.1, 0.0, 1.0) == pytest.approx(0.6)
    assert margin(0.5, 0.3, 0.4, 2.0) == pytest.approx(1.5)


@pytest.mark.parametrize("radius", [0.0, 0.4, 1.0, 2.3, 6.0])
def test_walls_are_thickened_by_exactly_the_radius(radius):
    rng = np.random.default_rng(5)
    costs = np.where(rng.random((40, 60)) < 0.01, np.inf, 1.0)
    fine = np.isinf(np.kron(costs, np.ones((21, 21))))  # the centre of a cell is a fine one
    away = distance_transform_edt(~fine)[10::21, 10::21] / 21.0
    closed = np.isinf(inflated(costs, radius))
    assert closed[np.isinf(costs)].all()
    near, far = away < radius - 0.03, away > radius + 0.06
    assert closed[near].all()
    assert not closed[far].any()


@pytest.mark.parametrize(
    ("start", "goal", "why"),
    [
        ((2.5, 0.0), GOAL, r"the start \(2.50, 0.00\) is inside a wall"),
        (START, (5.5, 5.0), r"the goal \(5.50, 5.00\) is inside a wall"),
        (START, (5.0, 5.0), "the goal .* is nearer to a wall than the 0.60 m to keep"),
        (START, (12.0, 0.0), "the goal .* is outside the map, which is -2.00 to 10.00 north"),
        ((0.0, -3.0), GOAL, "the start .* is outside the map"),
    ],
)
def test_impossible_values_are_reported(start, goal, why):
    with pytest.raises(NoRouteError, match=why):
        plan(ROOM, start, goal, Way(0.6))


def test_a_closed_room_has_no_way_in():
    closed = ROOM.with_walls([(2.5, 3.5 + 0.1 * n) for n in range(46)])
    with pytest.raises(NoRouteError, match=r"no way from \(0.03, -0.02\) to \(8.00, 6.00\) that"):
        plan(closed, START, GOAL, Way(0.6))


def test_a_start_within_the_margin_is_left_without_going_nearer():
    start = (2.0, 0.0)  # 0.4 m from the first wall
    route = plan(ROOM, start, GOAL, Way(0.6))
    near = gaps(route)
    assert near.min() > 0.3
    assert (near[120:] > 0.59).all()


def test_the_way_out_of_the_margin_does_not_lead_through_a_gap_that_is_narrower():
    box = [
        [(-0.6, -0.6), (0.6, -0.6), (0.6, -0.5), (-0.6, -0.5)],
        [(-0.6, 0.5), (0.6, 0.5), (0.6, 0.6), (-0.6, 0.6)],
        [(-0.6, -0.6), (-0.5, -0.6), (-0.5, 0.6), (-0.6, 0.6)],
        [(0.5, -0.6), (0.6, -0.6), (0.6, -0.2), (0.5, -0.2)],
        [(0.5, 0.2), (0.6, 0.2), (0.6, 0.6), (0.5, 0.6)],
    ]
    shed = drawn(AREA, 0.1, box)
    assert plan(shed, (0.0, 0.0), (2.0, 0.0), Way(0.15)).length == pytest.approx(2.0, abs=0.1)
    with pytest.raises(NoRouteError, match="no way"):
        plan(shed, (0.0, 0.0), (2.0, 0.0), Way(0.6))


def test_smoothing_does_not_cross_expensive_cells():
    ((south, west), _), costs = AREA, ROOM.costs.copy()
    costs[60:90, :] = np.where(np.isinf(costs[60:90, :]), np.inf, 4.0)
    swamp = Occupancy(costs, 0.1, (south, west))
    rough, smooth = (plan(swamp, START, GOAL, Way(0.6, smooth=smooth)) for smooth in (False, True))
    spent = sum(
        line_cost(costs, *swamp.cell(a), *swamp.cell(b)) * 0.1
        for a, b in zip(smooth.spots[:-1], smooth.spots[1:], strict=True)
    )
    assert spent <= rough.cost + 0.3


@pytest.mark.parametrize("seed", range(5))
def test_a_line_sees_every_cell_it_touches(seed):
    rng = np.random.default_rng(seed)
    costs = np.where(rng.random((20, 20)) < 0.1, np.inf, rng.uniform(1, 3, (20, 20)))
    for a, b in rng.uniform(0.0, 20.0, (100, 2, 2)):
        along = a + np.linspace(0.0, 1.0, 20_001)[:, None] * (b - a)
        cells = np.minimum(along.astype(int), 19)
        sampled = costs[cells[:, 0], cells[:, 1]]
        cost = line_cost(costs, *a, *b)
        if np.isinf(sampled).any():
            assert cost == math.inf
        elif cost < math.inf:  # a line may touch a corner between two samples
            assert cost == pytest.approx(sampled.mean() * np.hypot(*(b - a)), rel=2e-3)


def test_a_line_through_a_corner_needs_both_sides_free():
    costs = np.ones((4, 4))
    assert line_cost(costs, 0.5, 0.5, 3.5, 3.5) == pytest.approx(3.0 * math.sqrt(2.0))
    costs[1, 2] = np.inf
    assert line_cost(costs, 0.5, 0.5, 3.5, 3.5) == math.inf
    assert line_cost(costs, 3.5, 3.5, 0.5, 0.5) == math.inf
