"""A variant against another on the same seeds: how much better, and how surely."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

from scipy.optimize import brentq
from scipy.stats import binomtest, norm

from missionkit.campaigns.statistics import ConfidenceInterval

ABOVE = 1e-9  # where nothing was seen to differ, the test's own estimate is a root too


class Paired(NamedTuple):
    """A variant against another on the same random numbers."""

    n: int  # seeds flown by both
    only_first: int  # seeds on which only the first succeeded
    only_second: int
    gain: ConfidenceInterval  # of the second in success rate
    p_value: float  # of McNemar's exact test: that nothing but chance makes them differ


def compared(first: Sequence[bool], second: Sequence[bool]) -> Paired:
    """Compare two variants whose runs of equal place had equal seeds.

    Source: Q. McNemar, "Note on the sampling error of the difference between correlated
    proportions", 1947; exact, by the binomial distribution of the seeds that decide.
    """
    pairs = list(zip(first, second, strict=True))
    up = sum(after and not before for before, after in pairs)
    down = sum(before and not after for before, after in pairs)
    p_value = float(binomtest(up, up + down).pvalue) if up + down else 1.0
    return Paired(len(pairs), down, up, gain_interval(up, down, len(pairs)), p_value)


@cache
def gain_interval(up: int, down: int, n: int, confidence: float = 0.95) -> ConfidenceInterval:
    """Return the difference of two paired success rates with Tango's score interval.

    The bounds are where the score test of "the gain is d" is at the limit:

        |up - down - n d| = z sqrt(n (2 q + d (1 - d)))

    with q the likeliest rate of `down` given d: the larger root of
    2n q² + ((2n - up + down) d - up - down) q - down d (1 - d) = 0.
    Source: T. Tango, "Equivalence test and confidence interval for the difference in proportions
    for the paired-sample design", Statistics in Medicine 17, 1998.

    Args:
        up: pairs in which only the second succeeded.
        down: pairs in which only the first did.
        n: pairs. None: anything is possible.
        confidence: of the interval.
    """
    if n == 0:
        return ConfidenceInterval(math.nan, -1.0, 1.0)
    z = float(norm.ppf(0.5 + confidence / 2))
    low = -_highest(down, up, n, z)
    return ConfidenceInterval((up - down) / n, low, _highest(up, down, n, z))


def _highest(up: int, down: int, n: int, z: float) -> float:
    """Return the largest gain that the score test does not refute."""
    seen = (up - down) / n
    if seen == 1.0:
        return 1.0

    def beyond(gain: float) -> float:
        spread = 2.0 * _rate_of_down(up, down, n, gain) + gain * (1.0 - gain)
        return n * (gain - seen) - z * math.sqrt(n * max(0.0, spread))

    return float(brentq(beyond, seen + ABOVE, 1.0))


def _rate_of_down(up: int, down: int, n: int, gain: float) -> float:
    """Return the likeliest rate of pairs in which only the first succeeds, given the gain."""
    linear = (2 * n - up + down) * gain - up - down
    square = linear * linear + 8.0 * n * down * gain * (1.0 - gain)
    return (math.sqrt(max(0.0, square)) - linear) / (4.0 * n)
