"""Value iteration over a small Markov decision process.

    Q(s, a) = c(s, a) + γ Σ P(s' | s, a) V(s'),   V(s) = min_a Q(s, a)   (Bellman)

V is the least expected cost from a state on. Sweeps of the right-hand side converge for γ < 1, and
for γ = 1 if some choice of actions ends for certain. The policy they lead to is then evaluated
exactly, (I - γ P_π) V = c_π, and taken once no action is better than its own: V is then right to
`TOLERANCE`. Source: M. L. Puterman, "Markov decision processes", 1994, sections 6.3 and 7.2.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

TOLERANCE = 1e-9
"""Largest error in Bellman's equation, relative to the largest value if that is above 1."""
SWEEPS = 20_000
"""Most sweeps."""


class Choice(NamedTuple):
    """An action in a state."""

    action: int
    cost: float
    leads: Mapping[int, float]  # next state -> probability; they add up to 1


class MdpSolution(NamedTuple):
    """The best policy."""

    values: tuple[float, ...]  # least expected cost from each state
    policy: tuple[int | None, ...]  # action in each state, None where the process ends
    costs: tuple[Mapping[int, float], ...]  # in each state, Q of each action there


def solve(
    choices: Sequence[Sequence[Choice]], final: Sequence[float], discount: float
) -> MdpSolution | None:
    """Return the policy with the least expected cost, None if the sweeps do not converge.

    Args:
        choices: of each state; none: the process ends there.
        final: cost of ending in a state, used where there is no choice.
        discount: γ, above 0 and at most 1.
    """
    n = len(choices)
    flat = [(s, choice) for s, each in enumerate(choices) for choice in each]
    P, cost = np.zeros((len(flat), n)), np.array([choice.cost for _, choice in flat])
    for row, (_, choice) in enumerate(flat):
        for to, probability in choice.leads.items():
            P[row, to] = probability
    ends = np.cumsum([0, *map(len, choices)]).tolist()
    spans = [(s, a, b) for s, (a, b) in enumerate(itertools.pairwise(ends)) if b > a]
    V = np.array([0.0 if each else final[s] for s, each in enumerate(choices)])
    for sweep in range(SWEEPS):
        Q = cost + discount * (P @ V)
        best = [(s, a + int(np.argmin(Q[a:b]))) for s, a, b in spans]
        if (sweep & (sweep - 1)) == 0 or sweep == SWEEPS - 1:  # 0, 1, 2, 4, 8, ...
            exact = _evaluated(P, cost, V, best, discount)
            if exact is not None and _optimal(Q := cost + discount * (P @ exact), exact, spans):
                return _solution(choices, exact, Q, spans, dict(best))
        for s, row in best:
            V[s] = Q[row]
        if not np.isfinite(V).all():
            return None
    return None


def _evaluated(
    P: Array, cost: Array, V: Array, best: Sequence[tuple[int, int]], discount: float
) -> Array | None:
    """Return the exact cost (n,) of following `best`, None if it never ends."""
    A, b = np.eye(len(V)), V.copy()
    for s, row in best:
        A[s] -= discount * P[row]
        b[s] = cost[row]
    try:
        exact: Array = np.asarray(np.linalg.solve(A, b), dtype=np.float64)
    except np.linalg.LinAlgError:
        return None
    residual = np.abs(A @ exact - b).max(initial=0.0)
    sound = np.isfinite(exact).all() and residual <= TOLERANCE * max(1.0, np.abs(exact).max())
    return exact if sound else None


def _optimal(Q: Array, V: Array, spans: Sequence[tuple[int, int, int]]) -> bool:
    """Say whether V meets Bellman's equation: no action is better than the policy's."""
    limit = TOLERANCE * max(1.0, float(np.abs(V).max(initial=0.0)))
    return all(abs(float(Q[a:b].min()) - float(V[s])) <= limit for s, a, b in spans)


def _solution(
    choices: Sequence[Sequence[Choice]],
    V: Array,
    Q: Array,
    spans: Sequence[tuple[int, int, int]],
    best: Mapping[int, int],
) -> MdpSolution:
    costs: list[Mapping[int, float]] = [{} for _ in choices]
    policy: list[int | None] = [None] * len(choices)
    for s, a, b in spans:
        costs[s] = dict(zip((it.action for it in choices[s]), map(float, Q[a:b]), strict=True))
        policy[s] = choices[s][best[s] - a].action
    return MdpSolution(tuple(map(float, V)), tuple(policy), tuple(costs))
