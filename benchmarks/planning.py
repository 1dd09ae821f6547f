"""Shortest paths over a large grid, side by side with other route finders."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from benchmarks.measure import Table, installed, seconds, version_of
from missionkit.messages.occupancy import Costs
from missionkit.planning.astar import search

SIZE, BLOCKED = 1000, 0.3
START, GOAL = (2, 2), (SIZE - 3, SIZE - 3)
ROUNDS = 5
SLOW = 2.0  # s, from which one time is enough


class Finder(NamedTuple):
    """One way to find a path: prepared on a map, then timed."""

    name: str
    package: str
    prepare: Callable[[Costs], Callable[[], float]]  # the length of the path, edges of cells
    how: str


def tables() -> list[Table]:
    """Find one path with everything that is installed."""
    costs = field()
    found = [
        (finder, *_measured(finder, costs))
        for finder in FINDERS
        if installed(finder.name, finder.package)
    ]
    own = found[0][1]
    rows = [
        (finder.name, f"{1e3 * took:.1f}", f"{took / own:.1f}", f"{length:.1f}")
        for finder, took, length in found
    ]
    how = "\n".join(
        f"- {finder.name}{version_of(finder.package)}: {finder.how}." for finder, _, _ in found
    )
    note = (
        f"{SIZE} x {SIZE} cells, {100 * BLOCKED:.0f} % of them blocked at random, from corner to "
        f"corner, 8 neighbours and no corner cut unless said otherwise. Medians of {ROUNDS} times, "
        f"of one above {SLOW:.0f} s; processor time, graphs are built before, kernels compiled. "
        f"x: times missionkit's. Length in edges of cells.\n\n{how}"
    )
    return [Table("Planning", ("route finder", "ms", "x", "length"), rows, note)]


def field() -> Costs:
    """Return the map: 1 or infinite, with room at both ends."""
    costs = np.where(np.random.default_rng(0).random((SIZE, SIZE)) < BLOCKED, np.inf, 1.0)
    costs[:6, :6] = costs[-6:, -6:] = 1.0
    return costs


def _measured(finder: Finder, costs: Costs) -> tuple[float, float]:
    work = finder.prepare(costs)
    lengths: list[float] = []
    times = [seconds(lambda: lengths.append(work()))]
    if times[0] < SLOW:
        times = [seconds(work) for _ in range(ROUNDS)]
    return float(np.median(times)), lengths[0]


def _own(neighbours: Any, heuristic: Any = None) -> Callable[[Costs], Callable[[], float]]:
    def prepare(costs: Costs) -> Callable[[], float]:
        search(np.ones((3, 3)), (0, 0), (2, 2), neighbours, heuristic)  # compiles its kernel
        return lambda: search(costs, START, GOAL, neighbours, heuristic)[1]

    return prepare


def _skimage(costs: Costs) -> Callable[[], float]:
    from skimage.graph import route_through_array  # noqa: PLC0415

    closed = np.where(np.isinf(costs), -1.0, costs)
    return lambda: float(route_through_array(closed, START, GOAL, geometric=True)[1])


def _skimage_4(costs: Costs) -> Callable[[], float]:
    from skimage.graph import route_through_array  # noqa: PLC0415

    closed = np.where(np.isinf(costs), -1.0, costs)
    return lambda: float(
        route_through_array(closed, START, GOAL, fully_connected=False, geometric=True)[1]
    )


def _pathfinding(costs: Costs) -> Callable[[], float]:
    from pathfinding.core.diagonal_movement import DiagonalMovement  # noqa: PLC0415
    from pathfinding.core.grid import Grid  # noqa: PLC0415
    from pathfinding.finder.a_star import AStarFinder  # noqa: PLC0415

    free = np.isfinite(costs).astype(int).tolist()
    finder = AStarFinder(diagonal_movement=DiagonalMovement.only_when_no_obstacle)
    grid = Grid(matrix=free)

    def find() -> float:
        grid.cleanup()
        path, _ = finder.find_path(grid.node(*START), grid.node(*GOAL), grid)
        places = [(node.x, node.y) for node in path]
        return sum(map(math.dist, places[:-1], places[1:]))

    return find


def _networkx(costs: Costs) -> Callable[[], float]:
    import networkx as nx  # noqa: PLC0415

    here, there, price = _moves(costs)
    graph = nx.Graph()
    graph.add_weighted_edges_from(zip(here.tolist(), there.tolist(), price.tolist(), strict=True))

    def guess(a: int, b: int) -> float:
        up, side = abs(a // SIZE - b // SIZE), abs(a % SIZE - b % SIZE)
        return max(up, side) + (math.sqrt(2.0) - 1.0) * min(up, side)

    first, last = START[0] * SIZE + START[1], GOAL[0] * SIZE + GOAL[1]
    return lambda: float(nx.astar_path_length(graph, first, last, guess))


def _scipy(costs: Costs) -> Callable[[], float]:
    here, there, price = _moves(costs)
    graph = csr_matrix((price, (here, there)), shape=(costs.size, costs.size))
    first, last = START[0] * SIZE + START[1], GOAL[0] * SIZE + GOAL[1]
    return lambda: float(dijkstra(graph, directed=False, indices=first)[last])


def _moves(costs: Costs) -> tuple[Any, Any, Any]:
    """Return every move between free cells once: from, to, length."""
    numbers, free = np.arange(costs.size).reshape(costs.shape), np.isfinite(costs)
    parts = []
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        a = (slice(0, SIZE - down), slice(max(0, -right), SIZE - max(0, right)))
        b = (slice(down, SIZE), slice(max(0, right), SIZE + min(0, right)))
        open_ = free[a] & free[b]
        if down and right:
            open_ &= free[b[0], a[1]] & free[a[0], b[1]]
        count = int(open_.sum())
        parts.append(
            (numbers[a][open_], numbers[b][open_], np.full(count, math.hypot(down, right)))
        )
    here, there, price = (np.concatenate(part) for part in zip(*parts, strict=True))
    return here, there, price


_ANY = "it cuts corners, so that its path may be shorter"
FINDERS = (
    Finder("missionkit", "missionkit", _own(8), "A*, octile distance"),
    Finder("missionkit, euclidean", "missionkit", _own(8, "euclidean"), "P2's modified variant"),
    Finder("missionkit, 4 neighbours", "missionkit", _own(4), "P2's classical variant"),
    Finder("scikit-image", "scikit-image", _skimage, f"`route_through_array`, geometric; {_ANY}"),
    Finder(
        "scikit-image, 4 neighbours",
        "scikit-image",
        _skimage_4,
        "`route_through_array`, not fully connected",
    ),
    Finder("scipy", "scipy", _scipy, "Dijkstra to every cell over a sparse graph"),
    Finder(
        "pathfinding", "pathfinding", _pathfinding, "`AStarFinder`, `only_when_no_obstacle`, octile"
    ),
    Finder("networkx", "networkx", _networkx, "`astar_path_length`, octile distance"),
)
