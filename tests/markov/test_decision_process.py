"""Value iteration against every deterministic policy there is."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from missionkit.markov.decision_process import Choice, solve


def random_process(seed, n, actions, *, ends):
    """States of which the last ends, if it `ends`; each other one has one action or more."""
    rng = np.random.default_rng(seed)
    choices = []
    for _ in range(n):
        count = int(rng.integers(1, actions + 1))
        rows = rng.dirichlet(np.full(n, 0.7), size=count)
        costs = rng.uniform(0.1, 3.0, size=count)
        choices.append(
            [
                Choice(a, float(costs[a]), {to: float(p) for to, p in enumerate(rows[a])})
                for a in range(count)
            ]
        )
    if ends:
        choices[-1] = []
    return choices, rng.uniform(-5.0, 5.0, size=n).tolist()


def by_brute_force(choices, final, discount):
    """The least cost from each state over all deterministic policies that end, or go on for ever.

    The best stationary policy is best from every state at once.
    """
    n = len(choices)
    best = np.full(n, np.inf)
    for policy in itertools.product(*[each or [None] for each in choices]):
        A, b = np.eye(n), np.array(final)
        for s, choice in enumerate(policy):
            if choice is not None:
                b[s] = choice.cost
                for to, p in choice.leads.items():
                    A[s, to] -= discount * p
        best = np.minimum(best, np.linalg.solve(A, b))
    return best


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 2**32 - 1), st.integers(2, 5), st.sampled_from([0.5, 0.9, 0.99, 1.0]))
def test_no_deterministic_policy_is_better(seed, n, discount):
    choices, final = random_process(seed, n, 3, ends=discount == 1.0)
    found = solve(choices, final, discount)
    assert found is not None
    wanted = by_brute_force(choices, final, discount)
    assert found.values == pytest.approx(wanted, rel=1e-7, abs=1e-7)
    for s, action in enumerate(found.policy):
        if choices[s]:
            assert found.costs[s][action] == pytest.approx(min(found.costs[s].values()))


def test_the_costs_of_the_other_actions_are_those_of_taking_them_once():
    go = Choice(0, 1.0, {0: 0.5, 1: 0.5})
    stop = Choice(1, 5.0, {2: 1.0})
    found = solve([[go, stop], [], []], [0.0, 10.0, 0.0], 1.0)
    # going on costs 1 / 0.5 + 10 = 12, stopping 5; going on once, then stopping 1 + (5 + 10) / 2
    assert found.values == pytest.approx((5.0, 10.0, 0.0))
    assert found.policy == (1, None, None)
    assert found.costs[0] == pytest.approx({0: 8.5, 1: 5.0})


def test_a_process_that_never_ends_has_no_solution_without_discount():
    choices = [[Choice(0, 1.0, {1: 1.0})], [Choice(0, 1.0, {0: 1.0})]]
    assert solve(choices, [0.0, 0.0], 1.0) is None
    assert solve(choices, [0.0, 0.0], 0.9).values == pytest.approx((10.0, 10.0))


def test_a_reward_that_can_be_collected_for_ever_has_no_solution():
    choices = [[Choice(0, -1.0, {0: 1.0}), Choice(1, 0.0, {1: 1.0})], []]
    assert solve(choices, [0.0, 0.0], 1.0) is None
