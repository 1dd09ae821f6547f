"""Random maps, and Dijkstra's algorithm from scipy on the same moves."""

from __future__ import annotations

import math

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra


def random_costs(rng, *, weighted=False, most=24):
    """A map of random size and density; start and goal are the first and last free cell."""
    shape = tuple(rng.integers(1, most, 2))
    costs = rng.uniform(1.0, 5.0, shape) if weighted else np.ones(shape)
    costs[rng.random(shape) < rng.uniform(0.0, 0.5)] = np.inf
    return costs


def shortest(costs, start, goal, neighbours):
    """Return the cost of the cheapest path, by scipy."""
    numbers = np.arange(costs.size).reshape(costs.shape)
    links = []
    moves = [(0, 1), (1, 0)] + ([(1, 1), (1, -1)] if neighbours == 8 else [])
    for row, column in moves:
        here, there = _shifted(numbers, row, column)
        a, b = costs.ravel()[here], costs.ravel()[there]
        price = math.hypot(row, column) * (a + b) / 2.0
        if row and column:
            beside = np.stack([costs.ravel()[n] for n in _corners(numbers, column)])
            price = np.where(np.isinf(beside).any(axis=0), np.inf, price)
        free = np.isfinite(price)
        links.append((price[free], here[free], there[free]))
    price, here, there = (np.concatenate(parts) for parts in zip(*links, strict=True))
    graph = csr_matrix((price, (here, there)), shape=(costs.size, costs.size))
    first, last = numbers[start], numbers[goal]
    return float(dijkstra(graph, directed=False, indices=first)[last])


def _shifted(numbers, row, column):
    rows, columns = numbers.shape
    low, high = max(0, -column), columns - max(0, column)
    here = numbers[: rows - row, low:high]
    there = numbers[row:, low + column : high + column]
    return here.ravel(), there.ravel()


def _corners(numbers, column):
    """The two cells beside each diagonal move of `_shifted`."""
    below, left = (1, 0), (0, column)
    here, _ = _shifted(numbers, 1, column)
    columns = numbers.shape[1]
    return here + below[0] * columns, here + left[1]
