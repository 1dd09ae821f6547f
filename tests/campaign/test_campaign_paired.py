"""Two variants on the same seeds: the gain, its interval, and how often that is right."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import optimize, stats

from missionkit.campaigns.paired_comparison import compared, gain_interval

# true rates: only the first succeeds, only the second does
RATES = ((0.02, 0.02), (0.05, 0.05), (0.02, 0.1), (0.1, 0.1), (0.1, 0.3), (0.0, 0.1), (0.0, 0.02))


def test_variants_are_compared_seed_by_seed():
    first = [True] * 60 + [False] * 12 + [True] * 3 + [False] * 5
    second = [True] * 60 + [True] * 12 + [False] * 3 + [False] * 5
    paired = compared(first, second)
    assert (paired.n, paired.only_first, paired.only_second) == (80, 3, 12)
    assert paired.p_value == pytest.approx(stats.binomtest(3, 15).pvalue)
    assert paired.gain.value == pytest.approx(9 / 80)
    se = math.sqrt((15 / 80 - (9 / 80) ** 2) / 80)
    assert paired.gain.low == pytest.approx(9 / 80 - 1.96 * se, abs=0.015)
    assert compared([True], [True]).p_value == 1.0


def test_common_random_numbers_find_differences_that_separate_ones_miss():
    """Most of a flight's fate is its seed; the pairs see the small gain, two samples do not."""
    rng = np.random.default_rng(7)
    luck = rng.random(400)
    first, second = (luck < 0.80).tolist(), (luck < 0.83).tolist()
    assert compared(first, second).p_value < 0.01
    table = [[sum(first), 400 - sum(first)], [sum(second), 400 - sum(second)]]
    assert stats.fisher_exact(table).pvalue > 0.2


def test_nothing_that_differs_says_little_of_few_runs():
    every = compared([True] * 20, [True] * 20).gain
    bound = 1.96**2 / (20 + 1.96**2)  # where the score test of "no difference" is at its limit
    assert (every.value, every.low, every.high) == pytest.approx((0.0, -bound, bound), abs=1e-4)
    assert compared([False] * 20, [True] * 20).gain.low == pytest.approx(0.678, abs=1e-3)
    assert compared([False] * 20, [True] * 20).gain.high == 1.0
    nothing = compared([], []).gain
    assert math.isnan(nothing.value)
    assert (nothing.low, nothing.high) == (-1.0, 1.0)


def test_the_interval_is_the_one_in_the_textbook():
    """Fagerland, Lydersen, Laake, "Statistical Analysis of Contingency Tables", chapter 8."""
    found = gain_interval(1, 7, 21)
    assert (found.low, found.high) == pytest.approx((-0.517, -0.026), abs=5e-4)


@pytest.mark.parametrize(("up", "down", "n"), [(12, 2, 50), (40, 20, 160), (3, 0, 20), (0, 1, 9)])
def test_its_bounds_are_those_of_the_score_test(up, down, n):
    """The likeliest rates under a gain are here found by a search, not by their formula."""

    def score(gain):
        least = max(0.0, -gain)

        def unlikely(q):
            logs = (up, q + gain), (down, q), (n - up - down, 1.0 - 2.0 * q - gain)
            return -sum(count * math.log(max(rate, 1e-300)) for count, rate in logs if count)

        most = (1.0 - gain) / 2.0
        q = optimize.minimize_scalar(
            unlikely, bounds=(least, most), method="bounded", options={"xatol": 1e-12}
        ).x
        return (up - down - n * gain) / math.sqrt(n * (2.0 * q + gain * (1.0 - gain)))

    found = gain_interval(up, down, n)
    z = stats.norm.ppf(0.975)
    assert score(found.low) == pytest.approx(z, abs=1e-3)
    assert score(found.high) == pytest.approx(-z, abs=1e-3)
    assert gain_interval(down, up, n).low == pytest.approx(-found.high)


@pytest.mark.parametrize("n", [10, 20, 50, 100])
@pytest.mark.parametrize(("down", "up"), RATES)
def test_the_interval_covers_the_true_gain_as_often_as_it_says(n, down, up):
    """Over all outcomes, each with its probability: nothing is left to a simulation's chance."""
    counts = np.array([(b, c, n - b - c) for b in range(n + 1) for c in range(n + 1 - b)])
    chances = stats.multinomial.pmf(counts, n, (up, down, 1.0 - up - down))
    likely = chances > 1e-7
    covered = sum(
        chance
        for (b, c, _), chance in zip(counts[likely].tolist(), chances[likely], strict=True)
        if gain_interval(b, c, n).low <= up - down <= gain_interval(b, c, n).high
    )
    assert covered >= 0.93


def test_campaigns_that_are_simulated_cover_it_as_often():
    rng, gains = np.random.default_rng(11), []
    for up, down, _ in rng.multinomial(30, (0.08, 0.02, 0.90), size=2000).tolist():
        gains.append(gain_interval(up, down, 30))
    covered = np.mean([gain.low <= 0.06 <= gain.high for gain in gains])
    assert 0.94 <= covered <= 1.0
