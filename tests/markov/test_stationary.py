"""The stationary distribution against closed forms, eigenvectors and a direct solve."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from missionkit.markov.stationary import closed_classes, stationary

ENTRY = st.one_of(st.just(0.0), st.just(1.0), st.floats(1e-300, 1.0))
SEEDS = st.integers(0, 2**32 - 1)


def random_chain(seed, n):
    """A chain (n, n) in which some transitions are missing."""
    rng = np.random.default_rng(seed)
    weights = rng.exponential(size=(n, n)) * (rng.random((n, n)) < 0.6) + 1e-12 * np.eye(n)
    return weights / weights.sum(axis=1, keepdims=True)


def by_eigenvector(P):
    values, vectors = np.linalg.eig(P.T)
    one = vectors[:, np.argmin(abs(values - 1.0))].real
    return one / one.sum()


def by_direct_solve(P):
    n = len(P)
    A = np.vstack([P.T - np.eye(n), np.ones(n)])
    return np.linalg.lstsq(A, np.append(np.zeros(n), 1.0), rcond=None)[0]


@given(ENTRY, ENTRY)
def test_two_states_in_closed_form(a, b):
    found = stationary([[1.0 - a, a], [b, 1.0 - b]])
    if a == b == 0.0:
        assert found.probabilities is None
        assert found.closed == ((0,), (1,))
    else:
        assert found.probabilities == pytest.approx((b / (a + b), a / (a + b)), rel=1e-12)


@pytest.mark.parametrize(
    ("a", "b", "wanted"), [(0.3, 0.0, 1.0), (0.0, 0.3, 0.0), (0.2, 0.6, 0.25), (0.0, 0.0, None)]
)
def test_the_limits_are_exact_and_unknown_only_where_both_are_zero(a, b, wanted):
    found = stationary([[1.0 - a, a], [b, 1.0 - b]]).probabilities
    assert (None if found is None else found[1]) == wanted


@given(SEEDS, st.integers(1, 12))
def test_random_chains_agree_with_eigenvector_and_direct_solve(seed, n):
    P = random_chain(seed, n)
    found = stationary(P.tolist())
    ones = int((abs(np.linalg.eigvals(P) - 1.0) < 1e-8).sum())
    if found.probabilities is None:
        assert len(found.closed) > 1
        assert ones == len(found.closed)
        return
    assert found.probabilities == pytest.approx(by_eigenvector(P), abs=1e-9)
    assert found.probabilities == pytest.approx(by_direct_solve(P), abs=1e-9)


@given(SEEDS, st.integers(2, 8))
def test_it_is_a_distribution_that_the_chain_keeps_and_transient_states_have_none_of_it(seed, n):
    P = random_chain(seed, n)
    found = stationary(P.tolist())
    if found.probabilities is None:
        return
    pi = np.array(found.probabilities)
    assert (pi >= 0.0).all()
    assert pi.sum() == pytest.approx(1.0, abs=1e-12)
    assert pi @ P == pytest.approx(pi, abs=1e-12)
    assert {i for i in range(n) if pi[i] > 0.0} == set(found.closed[0])


@given(SEEDS, st.integers(2, 8), st.randoms(use_true_random=False))
def test_the_order_of_the_states_does_not_matter(seed, n, random):
    P = random_chain(seed, n)
    order = random.sample(range(n), n)
    one = stationary(P.tolist()).probabilities
    other = stationary(P[np.ix_(order, order)].tolist()).probabilities
    if one is None or other is None:
        assert one is other
    else:
        assert other == pytest.approx([one[i] for i in order], rel=1e-9, abs=1e-300)


def test_a_periodic_chain_keeps_its_unique_distribution():
    ring = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    found = stationary(ring)
    assert found.probabilities == pytest.approx((1 / 3, 1 / 3, 1 / 3))
    assert found.period == 3
    assert stationary([[0.5, 0.5, 0.0], *ring[1:]]).period == 1


def test_only_sets_that_cannot_be_left_are_closed():
    P = [[0.5, 0.5, 0, 0], [0, 0, 1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
    assert closed_classes(P) == ((1, 2), (3,))
    assert stationary(P).probabilities is None


def test_numbers_too_small_to_be_divided_by_are_not_guessed():
    tiny = 5e-324
    P = [[0.0, 0.5, 0.5], [tiny, 1.0, 0.0], [tiny, 0.0, 1.0]]
    found = stationary(P).probabilities
    assert found is None or sum(found) == pytest.approx(1.0)
