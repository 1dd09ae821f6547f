"""How far measurements lie from what a filter expects, in standard deviations.

    d = mean of sqrt(rᵀ S⁻¹ r / m) over the last second or so

r is the innovation, S its covariance and m the number of its components: d is about 0.8 (a
component alone) to 0.95 (three at once) while the filter's noise is right. Measurements that the
gate rejects count too: a filter that rejects everything is not consistent.

Source: P3 sections IV and V-B, the Mahalanobis distance d of Algorithm 1; the second is ours (the
paper does not say how d is averaged).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

TIME_CONSTANT = 1.0
"""Of the mean (s)."""
FORGOTTEN_AFTER = 3.0
"""Without a measurement for so long (s) the distance is not known."""
LARGEST_COUNTED = 100.0
"""One measurement counts at most this much."""


class MeanDistance(NamedTuple):
    """The running mean of the distances."""

    mean: float = 0.0
    at: float = -math.inf  # s, of the last measurement taken in


def distance(nis: float, components: int) -> float:
    """Return sqrt(ε / m) of one measurement, at most `LARGEST_COUNTED`."""
    return min(math.sqrt(nis / components), LARGEST_COUNTED) if nis >= 0.0 else LARGEST_COUNTED


def averaged(known: MeanDistance, distances: Sequence[float], now: float) -> MeanDistance:
    """Return the mean with the distances of one tick taken in.

    Args:
        known: the mean so far, with the time of its last measurement.
        distances: without unit, in standard deviations; empty leaves the mean as it is.
        now: s.
    """
    if not distances:
        return known
    news = sum(distances) / len(distances)
    gap = now - known.at
    gain = 1.0 if gap > FORGOTTEN_AFTER else -math.expm1(-gap / TIME_CONSTANT)
    return MeanDistance(known.mean + gain * (news - known.mean), now)


def current(known: MeanDistance, now: float) -> float | None:
    """Return the mean, None if nothing was measured lately."""
    return known.mean if now - known.at <= FORGOTTEN_AFTER else None
