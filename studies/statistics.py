"""The few statistics that the studies report."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from missionkit.campaigns import statistics


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
    _, low, high = statistics.wilson(successes, n, confidence)
    return Interval(max(0.0, low), min(1.0, high))


def spread(values: Sequence[float]) -> Spread:
    """Return the spread of a sample of at least one value."""
    least, p50, p95, most = np.percentile(values, (0, 50, 95, 100)).tolist()
    return Spread(least, p50, p95, most)


def rms(values: Sequence[float]) -> float:
    """Return the root mean square of at least one value."""
    return float(np.sqrt(np.mean(np.square(values))))
