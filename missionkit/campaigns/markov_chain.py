"""The chart as a Markov chain, estimated from flights.

Its states are those that command, its absorbing states the ways flights end. With Q the
probabilities from state to state, R those from state to ending and w the mean time of a visit:
    N = (I - Q)⁻¹        expected visits
    B = N R              probability of each ending
    t = N w              expected time to the end (s)
Source: J. G. Kemeny, J. L. Snell, "Finite Markov chains", 1960, chapter III.

The chain forgets how a state was reached; a flight may not. From where flights begin B and t are
the shares and the mean of the sample itself; from any other state they are the chain's word, which
stands beside the runs that passed it.
"""

from __future__ import annotations

import heapq
import math
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from missionkit.campaigns.run_row import Row
from missionkit.campaigns.statistics import Numbers


class Ending(NamedTuple):
    """How a flight ended, and in which state."""

    outcome: str
    state: str


class Chain(NamedTuple):
    """Counts from the runs of one variant."""

    states: tuple[str, ...]  # as first visited
    endings: tuple[Ending, ...]  # sorted
    starts: Numbers  # (n,) flights that began there
    moves: Numbers  # (n, n) from state to state
    ends: Numbers  # (n, m) from state to ending
    dwell: Numbers  # (n,) s, mean of a visit

    @property
    def inner(self) -> Numbers:
        """Q (n, n): probabilities from state to state."""
        return self.moves / self._visits

    @property
    def outer(self) -> Numbers:
        """R (n, m): probabilities from state to ending."""
        return self.ends / self._visits

    @property
    def _visits(self) -> Numbers:
        visits: Numbers = self.moves.sum(axis=1) + self.ends.sum(axis=1)
        return visits[:, np.newaxis]


def estimate(rows: Iterable[Row]) -> Chain:
    """Count the flights of some rows; those that gave no flight are left out."""
    flights = [row for row in rows if row.flew and row.visits]
    states = tuple(dict.fromkeys(state for row in flights for state, _ in row.visits))
    endings = tuple(sorted({_ending(row) for row in flights}))
    at = {state: n for n, state in enumerate(states)}
    n, m = len(states), len(endings)
    starts, moves, ends = np.zeros(n), np.zeros((n, n)), np.zeros((n, m))
    spent, visits = np.zeros(n), np.zeros(n)
    for row in flights:
        path = [at[state] for state, _ in row.visits]
        starts[path[0]] += 1
        ends[path[-1], endings.index(_ending(row))] += 1
        for source, target in pairwise(path):
            moves[source, target] += 1
        for state, seconds in row.visits:
            spent[at[state]] += seconds
            visits[at[state]] += 1
    return Chain(states, endings, starts, moves, ends, spent / np.maximum(visits, 1))


def _ending(row: Row) -> Ending:
    return Ending(row.outcome, row.visits[-1][0])


def absorbed(inner: Numbers, outer: Numbers) -> Numbers:
    """Return B (n, m): from each state, the probability of each ending."""
    return np.asarray(np.linalg.solve(np.eye(len(inner)) - inner, outer))


def time_left(inner: Numbers, dwell: Numbers) -> Numbers:
    """Return t (n,): from each state, the expected time to the end (s)."""
    return np.asarray(np.linalg.solve(np.eye(len(inner)) - inner, dwell))


class ChainPath(NamedTuple):
    """A path through the chart to an ending, and how probable exactly this one is."""

    states: tuple[str, ...]
    ending: Ending
    probability: float


def likeliest(chain: Chain, endings: Collection[Ending]) -> ChainPath | None:
    """Return the most probable path from a beginning to one of `endings`, `None` if there is none.

    The shortest path where a step costs -ln p (Dijkstra, 1959).
    """
    wanted = [n for n, ending in enumerate(chain.endings) if ending in endings]
    total = chain.starts.sum()
    begin = enumerate(chain.starts.tolist())
    heap: list[tuple[float, tuple[int, ...], int]] = [
        (-math.log(count / total), (state,), -1) for state, count in begin if count > 0
    ]
    heapq.heapify(heap)
    settled = set[int]()
    while heap:
        cost, path, end = heapq.heappop(heap)
        if end >= 0:
            names = tuple(chain.states[state] for state in path)
            return ChainPath(names, chain.endings[end], math.exp(-cost))
        if path[-1] in settled:
            continue
        settled.add(path[-1])
        for step, to, ending in _steps(chain, path[-1], wanted):
            heapq.heappush(heap, (cost + step, (*path, to) if to >= 0 else path, ending))
    return None


def _steps(chain: Chain, state: int, wanted: Sequence[int]) -> Iterator[tuple[float, int, int]]:
    """Yield cost, next state or -1, ending or -1, of every step out of a state."""
    for to, p in enumerate(chain.inner[state].tolist()):
        if p > 0.0:
            yield -math.log(p), to, -1
    for end in wanted:
        p = float(chain.outer[state, end])
        if p > 0.0:
            yield -math.log(p), -1, end


def passed(rows: Iterable[Row]) -> dict[str, tuple[int, int]]:
    """Return for each state how many flights were ever in it, and how many of them succeeded."""
    flights, good = Counter[str](), Counter[str]()
    for row in rows:
        if row.flew:
            seen = {state for state, _ in row.visits}
            flights.update(seen)
            if row.succeeded:
                good.update(seen)
    return {state: (count, good[state]) for state, count in flights.items()}
