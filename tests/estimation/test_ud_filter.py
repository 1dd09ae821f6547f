"""The factorised filter against the conventional one, and where single precision breaks that."""

from __future__ import annotations

import numpy as np
import pytest

from missionkit.estimation.ud_filter.factors import (
    add_rank_one,
    covariance,
    factorised,
    forget,
    predict,
    predict_first,
    update,
)
from studies.ud_filter_runs import (
    FILTERS,
    dyer_mcreynolds,
    exact_covariance,
    flight,
    positions,
)

UD, PLAIN, _ = FILTERS.values()
DELTA = 3.45e-4  # delta² is lost beside 1 in single precision, delta is not


@pytest.mark.parametrize("n", [1, 3, 9, 27])
def test_in_double_precision_it_is_the_conventional_filter(n):
    rng = np.random.default_rng(n)
    root = rng.normal(size=(n, n))
    P, x = root @ root.T + 0.1 * np.eye(n), rng.normal(size=n)
    (U, D), y = factorised(P), x.copy()
    for _ in range(20):
        F, G = np.eye(n) + 0.1 * rng.normal(size=(n, n)), rng.normal(size=(n, n // 2 + 1))
        q = rng.uniform(0.0, 0.1, n // 2 + 1)
        P, x, y = F @ P @ F.T + G @ np.diag(q) @ G.T, F @ x, F @ y
        predict(U, D, F, G, q)
        for _ in range(3):
            h, z, R = rng.normal(size=n), rng.normal(), rng.uniform(0.1, 1.0)
            S = h @ P @ h + R
            K = P @ h / S
            assert update(y, U, D, h, z - h @ y, R) == pytest.approx(S, rel=1e-9)
            x, P = x + K * (z - h @ x), P - np.outer(K, h @ P)
        np.testing.assert_allclose(covariance(U, D), P, rtol=0, atol=1e-9 * np.abs(P).max())
        np.testing.assert_allclose(y, x, rtol=0, atol=1e-9 * np.abs(x).max())
        assert (np.triu(U) == U).all()
        assert (np.diag(U) == 1.0).all()


def test_a_covariance_without_full_rank_is_factorised():
    P = np.diag([2.0, 0.0, 3.0])
    U, D = factorised(P)
    np.testing.assert_array_equal(covariance(U, D), P)
    x = np.zeros(3)
    update(x, U, D, np.ones(3), 1.0, 0.5)
    predict(U, D, np.diag([1.0, 0.0, 1.0]), np.zeros((3, 1)), np.zeros(1))
    assert np.isfinite(U).all()
    assert D[1] == x[1] == 0.0


def test_all_arithmetic_stays_in_single_precision():
    U, D = factorised(np.eye(3, dtype=np.float32))
    assert U.dtype == D.dtype == covariance(U, D).dtype == np.float32
    x, h = np.zeros(3, np.float32), np.ones(3, np.float32)
    assert update(x, U, D, h, np.float32(0.0), np.float32(1e-9)) == 3.0  # 1e-9 is lost beside 3


def test_two_nearly_equal_rows_leave_it_a_covariance_and_the_other_not():
    """Dyer and McReynolds' example at the delta whose square is just lost."""
    exact = exact_covariance(DELTA)
    ours = dyer_mcreynolds(UD, DELTA)
    assert np.linalg.norm(ours - exact) <= 1e-3 * np.linalg.norm(exact)
    assert np.linalg.eigvalsh(ours).min() > 0.0
    theirs = dyer_mcreynolds(PLAIN, DELTA)
    assert np.linalg.eigvalsh(0.5 * (theirs + theirs.T)).min() < 0.0


def test_a_wide_prior_costs_single_precision_nothing():
    """27 states, features known to 100 m: against the same filter in double precision."""
    steps = flight(seed=5, steps=80)
    exact = positions(PLAIN, np.float64, steps)
    off = [
        np.linalg.norm(positions(how, np.float32, steps) - exact, axis=1).max()
        for how in (UD, PLAIN)
    ]
    assert off[0] <= 0.004
    assert off[1] > 0.023


def ungainly(n):
    rng = np.random.default_rng(n)
    root = rng.normal(size=(n, n))
    return rng, root @ root.T + 0.1 * np.eye(n)


def test_a_prediction_of_the_first_states_is_that_of_all():
    rng, P = ungainly(9)
    F, G, q = np.eye(9), np.zeros((9, 2)), np.array([0.3, 0.1])
    F[:4, :4] += 0.2 * rng.normal(size=(4, 4))
    G[:4] = rng.normal(size=(4, 2))
    (U, D), (V, E) = factorised(P), factorised(P)
    predict(U, D, F, G, q)
    predict_first(V, E, F[:4, :4].copy(), G[:4].copy(), q)
    np.testing.assert_allclose(V, U, rtol=0, atol=1e-12)
    np.testing.assert_allclose(E, D, rtol=0, atol=1e-12)


def test_a_dyad_is_added():
    rng, P = ungainly(7)
    U, D = factorised(P)
    a = rng.normal(size=5)
    added = np.zeros((7, 7))
    added[:5, :5] = 0.7 * np.outer(a, a)
    add_rank_one(U, D, a.copy(), 0.7)
    np.testing.assert_allclose(covariance(U, D), P + added, rtol=0, atol=1e-12)


def test_states_are_forgotten_and_the_others_keep_what_they_know():
    _, P = ungainly(9)
    U, D = factorised(P)
    forget(U, D, 3, 3, 25.0)
    P[3:6] = P[:, 3:6] = 0.0
    P[range(3, 6), range(3, 6)] = 25.0
    np.testing.assert_allclose(covariance(U, D), P, rtol=0, atol=1e-12)
    forget(U, D, 0, 9, 0.0)
    np.testing.assert_array_equal(covariance(U, D), np.zeros((9, 9)))
