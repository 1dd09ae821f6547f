"""The few statistics that the studies report."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import NormalDist
from typing import NamedTuple

import numpy as np


class Interval(NamedTuple):
    """A confidence interval."""

    low: float
    high: float


class Spread(NamedTuple):
    """Median, 95th percentile and both ends of a sample."""

    least: float
    p50: float
    p95: float
    most: float


def wilson(successes: int, n: int, confidence: float = 0.95) -> Interval:
    """Return the interval in which the probability behind `successes` of `n` lies.

        (p + z²/2n ± z sqrt(p (1 - p)/n + z²/4n²)) / (1 + z²/n),   p = successes/n

    Unlike p ± z sqrt(p (1 - p)/n) it does not shrink to a point when every flight succeeds.

    Source: E. B. Wilson, "Probable inference", 1927; Brown, Cai and DasGupta, 2001.

    Raises:
        ValueError: `n` is not positive, or `successes` is not within 0 to `n`.
    """
    if not 0 <= successes <= n or n == 0:
        raise ValueError(f"{successes} successes of {n}")
    z = NormalDist().inv_cdf(0.5 + 0.5 * confidence)
    share, scale = successes / n, 1.0 + z * z / n
    middle = (share + z * z / (2.0 * n)) / scale
    half = z / scale * math.sqrt(share * (1.0 - share) / n + z * z / (4.0 * n * n))
    return Interval(max(0.0, middle - half), min(1.0, middle + half))


def spread(values: Sequence[float]) -> Spread:
    """Return the spread of a sample of at least one value."""
    least, p50, p95, most = np.percentile(values, (0, 50, 95, 100)).tolist()
    return Spread(least, p50, p95, most)


def rms(values: Sequence[float]) -> float:
    """Return the root mean square of at least one value."""
    return float(np.sqrt(np.mean(np.square(values))))
