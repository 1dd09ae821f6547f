"""Whether the innovations of sightings are as large as the filter's noise says: the NIS test.

With the right noise ε = rᵀ S⁻¹ r is chi-square distributed with as many degrees of freedom m as the
measurement has, so ε/m is 1 on average. A running mean of it over `WINDOW` sightings that exceeds
`MOST` says, until it is below `FITTING` again, that the sensors, or the motion, are noisier than
the filter believes: its standard deviations are then too small, and what has converged by them may
be far away. The other sensors' noise is inflated on purpose, for their errors drift, so theirs
tells nothing.

Source: Bar-Shalom, Li and Kirubarajan, "Estimation with Applications to Tracking and Navigation",
2001, section 5.4.2.
"""

from __future__ import annotations

import math
from typing import NamedTuple

FREEDOM = 3
"""m, of a sighting."""
WINDOW = 40
"""Sightings in the mean, 2 s of them."""
MOST = 1.55
"""Chance alone reaches it once in ten thousand windows: χ²(0.9999; 3 · 40) / (3 · 40)."""
FITTING = 1.2
"""Ninety of a hundred windows lie below it if the noise is right."""
LARGEST = 10.0
"""ε/m of one sighting counts at most so much: a false marker is no noise."""


class Scatter(NamedTuple):
    """The mean of ε/m of the last sightings, how many are in it, and whether it does not fit."""

    mean: float = 0.0
    taken: int = 0
    noisy: bool = False


def averaged(scatter: Scatter, epsilon: float) -> Scatter:
    """Return the mean with the ε of one more sighting taken in, unless it is not a number."""
    if not math.isfinite(epsilon):
        return scatter
    count = min(scatter.taken + 1, WINDOW)
    news = min(epsilon / FREEDOM, LARGEST)
    mean = scatter.mean + (news - scatter.mean) / count
    return Scatter(mean, count, count >= WINDOW and mean > (FITTING if scatter.noisy else MOST))


def misfit(scatter: Scatter) -> str:
    """Say how the sightings do not fit the filter's noise; empty if they do, or few were taken."""
    if not scatter.noisy:
        return ""
    return (
        f"sightings scatter {math.sqrt(scatter.mean):.1f} times as far as the filter's noise says"
    )
