"""When guards would hold if their values went on as they did: a straight line through each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

SPAN = 60.0  # s of the past that a line is fitted to
FEWEST = 10  # values
LONGEST = 3600.0  # s; a line is no evidence for longer


class Outlook(NamedTuple):
    """When a transition would be taken if nothing changes."""

    after: float  # s from the time in question
    evidence: str  # a sentence


def slope_of(points: Sequence[tuple[float, float]]) -> float:
    """Return how much a value grows in a second, by least squares.

    Args:
        points: time (s) and value, at two times at least.
    """
    mean_at = sum(at for at, _ in points) / len(points)
    mean = sum(value for _, value in points) / len(points)
    spread = sum((at - mean_at) ** 2 for at, _ in points)
    return sum((at - mean_at) * (value - mean) for at, value in points) / spread


def outlook(guard: str, margins: Sequence[tuple[float, float]]) -> Outlook | None:
    """Return when a guard that does not hold would; None: its margin does not grow.

    Args:
        guard: as a person would say it.
        margins: time (s) and margin, oldest first; the last is negative.
    """
    now, margin = margins[-1]
    recent = [(at, it) for at, it in margins if now - at <= SPAN]
    if len(recent) < FEWEST:
        return None
    slope = slope_of(recent)
    after = -margin / slope if slope > 0.0 else LONGEST
    if not after < LONGEST:
        return None
    span = now - recent[0][0]
    return Outlook(
        after,
        f"the margin of {guard} grows by {slope:.3g} a second over the last {span:.0f} s, "
        f"and {-margin:.3g} is missing",
    )
