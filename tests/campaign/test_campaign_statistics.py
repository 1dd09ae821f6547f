from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from missionkit.campaigns.statistics import bootstrap, differences, quantile, wilson


@pytest.mark.parametrize("n", [1, 7, 40, 500])
@pytest.mark.parametrize("confidence", [0.8, 0.95, 0.99])
def test_wilson_is_that_of_scipy(n, confidence):
    for successes in range(0, n + 1, max(1, n // 7)):
        ours = wilson(successes, n, confidence)
        theirs = stats.binomtest(successes, n).proportion_ci(confidence, method="wilson")
        assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), abs=1e-12)
        assert ours.value == successes / n


def test_nothing_flown_says_nothing():
    none = wilson(0, 0)
    assert math.isnan(none.value)
    assert (none.low, none.high) == (0.0, 1.0)
    assert math.isnan(bootstrap([], np.median, np.random.default_rng(0)).value)


@pytest.mark.parametrize("q", [0.05, 0.5, 0.95])
def test_quantiles_and_their_intervals_are_those_of_scipy(q):
    values = np.random.default_rng(1).gamma(3.0, size=200)
    ours = quantile(values, q, np.random.default_rng(2))
    theirs = stats.bootstrap(
        (values,),
        lambda it, axis: np.quantile(it, q, axis=axis),
        n_resamples=4000,
        method="percentile",
        rng=np.random.default_rng(3),
    ).confidence_interval
    spread = theirs.high - theirs.low
    assert ours.value == np.quantile(values, q)
    assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), abs=0.12 * spread)


def test_the_interval_of_a_median_covers_it_about_as_often_as_it_says():
    rng, truth = np.random.default_rng(4), math.log(2.0)
    intervals = [quantile(rng.exponential(size=60), 0.5, rng) for _ in range(200)]
    covered = sum(it.low <= truth <= it.high for it in intervals)
    assert 0.91 <= covered / 200 <= 0.98


def test_large_samples_are_drawn_in_pieces_of_the_same_kind():
    values = np.random.default_rng(5).normal(size=4_000)
    drawn = quantile(values, 0.5, np.random.default_rng(6))
    assert drawn.width == pytest.approx(2 * 1.96 * 1.2533 / math.sqrt(4_000), rel=0.15)


def test_differences_are_taken_where_both_were_measured():
    assert differences([1.0, None, 3.0], [1.5, 2.0, None]) == [0.5]
