"""The stationary distribution of a Markov chain of a few states.

    π P = π,   Σ π = 1

It is unique if the chain has one closed class: states that lead to each other and nowhere else.
A state outside of it is transient and has probability 0. Source: J. R. Norris, "Markov chains",
1998, sections 1.2, 1.7 and 1.8.

Within the class the distribution is computed by state reduction, which adds, multiplies and
divides numbers that are not negative but never subtracts: every probability is right to nearly all
of its digits, however small. Source: W. K. Grassmann, M. I. Taksar and D. P. Heyman, "Regenerative
analysis and steady state distributions for Markov chains", Operations Research 33 (1985).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

Matrix = Sequence[Sequence[float]]
"""(n, n): from the state of the row to that of the column; each row adds up to 1."""


class Stationary(NamedTuple):
    """The long run of a chain."""

    probabilities: tuple[float, ...] | None  # (n,), None: not unique, or not computable
    closed: tuple[tuple[int, ...], ...]  # the closed classes, by first state
    period: int  # of the only closed class: it comes back to a state in multiples of it


def stationary(matrix: Matrix) -> Stationary:
    """Return the stationary distribution of a chain.

    Args:
        matrix: (n, n), transition probabilities, at least 0; only those from one state to another
            count, what remains in a row is the probability of staying.
    """
    classes = closed_classes(matrix)
    if len(classes) != 1:
        return Stationary(None, classes, 0)
    (members,) = classes
    inside = _reduced([[float(matrix[i][j]) for j in members] for i in members])
    if inside is None:
        return Stationary(None, classes, period(matrix, members))
    found = [0.0] * len(matrix)
    for state, probability in zip(members, inside, strict=True):
        found[state] = probability
    return Stationary(tuple(found), classes, period(matrix, members))


def closed_classes(matrix: Matrix) -> tuple[tuple[int, ...], ...]:
    """Return the closed classes of a chain: sets of states that it cannot leave."""
    n = len(matrix)
    reach = [_bits(matrix[i]) | 1 << i for i in range(n)]
    for k in range(n):
        for i in range(n):
            if reach[i] >> k & 1:
                reach[i] |= reach[k]
    classes = dict.fromkeys(
        bits
        for bits in reach
        if all(reach[other] == bits for other in range(n) if bits >> other & 1)
    )
    return tuple(tuple(i for i in range(n) if bits >> i & 1) for bits in classes)


def period(matrix: Matrix, members: Sequence[int]) -> int:
    """Return the period of a closed class: the greatest common divisor of its circles' lengths."""
    first = members[0]
    steps, waiting, found = {first: 0}, [first], 0
    while waiting:
        state = waiting.pop()
        for to in members:
            if not matrix[state][to] > 0.0:
                continue
            if to not in steps:
                steps[to] = steps[state] + 1
                waiting.append(to)
            found = math.gcd(found, steps[state] + 1 - steps[to])
    return found


def _bits(row: Sequence[float]) -> int:
    return sum(1 << j for j, probability in enumerate(row) if probability > 0.0)


def _reduced(P: list[list[float]]) -> list[float] | None:
    """Return π (m,) of an irreducible chain (m, m), None if its numbers are too small for it."""
    m = len(P)
    for k in range(m - 1, 0, -1):
        leaving = sum(P[k][:k])
        if not leaving > 0.0:
            return None
        for i in range(k):
            P[i][k] /= leaving
            for j in range(k):
                P[i][j] += P[i][k] * P[k][j]
    weights = [1.0]
    for k in range(1, m):
        weights.append(sum(weights[i] * P[i][k] for i in range(k)))
    total = sum(weights)
    return [weight / total for weight in weights] if math.isfinite(total) else None
