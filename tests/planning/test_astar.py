"""A* against Dijkstra's algorithm, and what a path must be like."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from grids import random_costs, shortest

from missionkit.planning import astar
from missionkit.planning.astar import search

WAYS = [
    (4, "manhattan"),
    (4, "euclidean"),
    (4, "octile"),
    (8, "euclidean"),
    (8, "octile"),
]
FREE = np.ones((5, 7))


def ends(costs):
    free = np.argwhere(np.isfinite(costs))
    return (tuple(free[0].tolist()), tuple(free[-1].tolist())) if len(free) else None


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize(("neighbours", "heuristic"), WAYS)
def test_no_path_is_cheaper_than_that_of_a_star(neighbours, heuristic, weighted):
    rng = np.random.default_rng(neighbours)
    found = 0
    for _ in range(100):
        costs = random_costs(rng, weighted=weighted)
        at = ends(costs)
        if at is None:
            continue
        cells, cost = search(costs, *at, neighbours, heuristic)
        assert cost == pytest.approx(shortest(costs, *at, neighbours), rel=1e-9)
        if len(cells):
            found += 1
            assert cost == pytest.approx(price(costs, cells, neighbours), rel=1e-9)
            assert (tuple(cells[0]), tuple(cells[-1])) == at
    assert found > 30


def price(costs, cells, neighbours):
    """Return the cost of a path; fails at an impossible move or a cut corner."""
    total = 0.0
    for (r, c), (row, column) in pairwise(cells.tolist()):
        step = abs(row - r) + abs(column - c)
        assert max(abs(row - r), abs(column - c)) == 1
        assert step == 1 or neighbours == 8
        assert np.isfinite([costs[row, c], costs[r, column]]).all()
        total += math.sqrt(step) * (costs[r, c] + costs[row, column]) / 2.0
    return total


def test_the_lengths_of_the_two_variants_of_the_paper():
    assert search(FREE, (0, 0), (4, 6), 4)[1] == 10.0
    assert search(FREE, (0, 0), (4, 6), 8, "euclidean")[1] == pytest.approx(2 + 4 * math.sqrt(2))


def test_of_equal_ways_the_straight_one_is_taken():
    cells, _ = search(np.ones((30, 30)), (0, 0), (29, 29), 4)
    turns = np.abs(np.diff(np.diff(cells, axis=0), axis=0)).any(axis=1).sum()
    assert turns == 1


def test_no_corner_is_cut():
    costs = np.ones((2, 2))
    costs[0, 1] = np.inf
    assert search(costs, (0, 0), (1, 1), 8)[1] == 2.0
    costs[1, 0] = np.inf
    assert search(costs, (0, 0), (1, 1), 8)[1] == math.inf


def test_costly_ground_is_bypassed_if_that_is_cheaper():
    costs = np.ones((3, 9))
    costs[1, 2:7] = 5.0
    cells, _ = search(costs, (1, 0), (1, 8), 8)
    assert not any(costs[row, column] == 5.0 for row, column in cells)
    costs[1, 2:7] = 1.05
    assert (search(costs, (1, 0), (1, 8), 8)[0][:, 0] == 1).all()


@pytest.mark.parametrize("blocked", [(0, 0), (4, 6)])
def test_there_is_no_path_out_of_or_into_a_wall(blocked):
    costs = FREE.copy()
    costs[blocked] = np.inf
    cells, cost = search(costs, (0, 0), (4, 6))
    assert (len(cells), cost) == (0, math.inf)


def test_standing_at_the_goal_costs_nothing():
    cells, cost = search(FREE, (2, 3), (2, 3))
    assert (cells.tolist(), cost) == ([[2, 3]], 0.0)


def test_a_heuristic_that_overestimates_is_refused():
    with pytest.raises(ValueError, match="overestimates diagonal moves"):
        search(FREE, (0, 0), (1, 1), 8, "manhattan")


KERNELS = ("_distance", "_push", "_pop", "_grown", "_step", "_search")


def test_without_numba_the_path_is_the_same(monkeypatch):
    rng = np.random.default_rng(3)
    maps = [random_costs(rng, weighted=n % 2 == 0, most=40) for n in range(20)]
    maps = [costs for costs in maps if ends(costs)]
    compiled = [search(costs, *ends(costs)) for costs in maps]
    for name in KERNELS:
        kernel = getattr(astar, name)
        monkeypatch.setattr(astar, name, getattr(kernel, "py_func", kernel))
    for costs, (cells, cost) in zip(maps, compiled, strict=True):
        plain, same = search(costs, *ends(costs))
        assert cost == same
        np.testing.assert_array_equal(plain, cells)
