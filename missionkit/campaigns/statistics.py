"""Statistics of a campaign: estimates from a sample of flights, with confidence intervals."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.stats import norm

Numbers = npt.NDArray[np.float64]

RESAMPLES = 2000
DRAWN_AT_A_TIME = 1_000_000  # numbers drawn at a time


class ConfidenceInterval(NamedTuple):
    """An estimate with its bounds at the requested confidence."""

    value: float
    low: float
    high: float

    @property
    def width(self) -> float:
        """From bound to bound."""
        return self.high - self.low


def wilson(successes: int, n: int, confidence: float = 0.95) -> ConfidenceInterval:
    """Return a success rate with Wilson's score interval.

    (p + z²/2n ± z √(p(1-p)/n + z²/4n²)) / (1 + z²/n).  Source: E. B. Wilson, "Probable inference,
    the law of succession, and statistical inference", 1927. No runs: anything is possible.

    Args:
        successes: 0 to `n`.
        n: runs.
        confidence: of the two-sided interval, in (0, 1).
    """
    if n == 0:
        return ConfidenceInterval(math.nan, 0.0, 1.0)
    z = _z(confidence)
    p, shrink = successes / n, 1.0 + z * z / n
    middle = (p + z * z / (2 * n)) / shrink
    half = z / shrink * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    low = 0.0 if successes == 0 else middle - half
    return ConfidenceInterval(p, low, 1.0 if successes == n else middle + half)


@cache
def _z(confidence: float) -> float:
    return float(norm.ppf(0.5 + confidence / 2))


def quantile(
    values: Sequence[float], q: float, rng: np.random.Generator, confidence: float = 0.95
) -> ConfidenceInterval:
    """Return a quantile with its percentile bootstrap interval; NaN without values.

    Args:
        values: (N,), finite, in any unit.
        q: 0 to 1; 0.5 is the median.
        rng: draws the bootstrap samples.
        confidence: of the two-sided interval, in (0, 1).
    """
    return bootstrap(values, lambda drawn: np.quantile(drawn, q, axis=-1), rng, confidence)


def bootstrap(
    values: Sequence[float],
    statistic: Callable[[Numbers], Numbers],
    rng: np.random.Generator,
    confidence: float = 0.95,
    resamples: int = RESAMPLES,
) -> ConfidenceInterval:
    """Return a statistic with its percentile bootstrap interval.

    Args:
        values: the sample.
        statistic: of the last axis of an array.
        rng: draws the resamples.
        confidence: of the interval.
        resamples: how many are drawn.

    Source: B. Efron, "Bootstrap methods: another look at the jackknife", 1979.
    """
    sample = np.asarray(values, dtype=float)
    if len(sample) == 0:
        return ConfidenceInterval(math.nan, math.nan, math.nan)
    found, left = [], resamples
    while left:
        some = min(left, max(1, DRAWN_AT_A_TIME // len(sample)))
        picks = rng.integers(0, len(sample), (some, len(sample)))
        found.append(np.atleast_1d(statistic(sample[picks])))
        left -= some
    tails = (0.5 - confidence / 2, 0.5 + confidence / 2)
    low, high = np.quantile(np.concatenate(found), tails)
    return ConfidenceInterval(float(statistic(sample)), float(low), float(high))


def differences(first: Sequence[float | None], second: Sequence[float | None]) -> list[float]:
    """Return second minus first where both were measured."""
    pairs = zip(first, second, strict=True)
    return [b - a for a, b in pairs if a is not None and b is not None]
