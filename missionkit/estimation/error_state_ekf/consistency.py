"""Whether the innovations of sightings are as large as the filter's noise says: the NIS test.

With the right noise ε = rᵀ S⁻¹ r is chi-square distributed with as many degrees of freedom m as the
measurement has, so ε/m is 1 on average. A running mean of it over `MEAN_WINDOW` sightings that
exceeds `NOISY_ABOVE` says, until it is below `CONSISTENT_BELOW` again, that the sensors, or the
motion, are noisier than the filter believes: its standard deviations are then too small, and what
has converged by them may be far away. The other sensors' noise is inflated on purpose, for their
errors drift, so theirs tells nothing.

Source: Bar-Shalom, Li and Kirubarajan, "Estimation with Applications to Tracking and Navigation",
2001, section 5.4.2.
"""

from __future__ import annotations

import math
from typing import NamedTuple

FREEDOM = 3
"""m, of a sighting."""
MEAN_WINDOW = 40
"""Sightings in the mean, 2 s of them."""
NOISY_ABOVE = 1.55
"""Chance alone reaches it once in ten thousand windows: χ²(0.9999; 3 · 40) / (3 · 40)."""
CONSISTENT_BELOW = 1.2
"""Ninety of a hundred windows lie below it if the noise is right."""
LARGEST_NIS = 10.0
"""ε/m of one sighting counts at most this much: a false marker is not noise."""


class NisAverage(NamedTuple):
    """The mean of ε/m of the last sightings, how many are in it, and whether it does not fit."""

    mean: float = 0.0
    taken: int = 0
    noisy: bool = False


def averaged(scatter: NisAverage, epsilon: float) -> NisAverage:
    """Return the mean with the ε of one more sighting taken in, unless it is not a number."""
    if not math.isfinite(epsilon):
        return scatter
    count = min(scatter.taken + 1, MEAN_WINDOW)
    news = min(epsilon / FREEDOM, LARGEST_NIS)
    mean = scatter.mean + (news - scatter.mean) / count
    return NisAverage(
        mean,
        count,
        count >= MEAN_WINDOW and mean > (CONSISTENT_BELOW if scatter.noisy else NOISY_ABOVE),
    )


def misfit(scatter: NisAverage) -> str:
    """Say how the sightings do not fit the filter's noise; empty if they do, or few were taken."""
    if not scatter.noisy:
        return ""
    ratio = math.sqrt(scatter.mean)
    return f"sightings scatter {ratio:.1f} times as far as the filter's noise model predicts"
