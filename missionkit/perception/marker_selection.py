"""Which of the markers in view to believe: P1 section 5."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from missionkit.geometry import Vec3, norm
from missionkit.messages import Sighting, Target

GATE_SIGMAS: Final = 5.0
GATE_LEAST: Final = 3.0  # m


class Candidate(NamedTuple):
    """One sighting of a target, and where in the world that would put the target."""

    sighting: Sighting
    position: Vec3 | None  # (3,), m, NED; None while the vehicle's own pose is unknown


def area_of(corners: npt.NDArray[np.float64]) -> float:
    """Return the area (px²) of a quadrilateral (4, 2), px, corners in order.

        A = ||(c1 - c3) × (c2 - c4)|| / 2

    Source: P1 section 5.1; exact for any simple quadrilateral.
    """
    a, b = corners[0] - corners[2], corners[1] - corners[3]
    return 0.5 * abs(float(a[0] * b[1] - a[1] * b[0]))


def plausible(candidate: Candidate, prior: Target | None) -> bool:
    """Say whether a sighting lies near enough to the estimated position of its target.

    A marker with the same id elsewhere is refused once it is farther than five standard
    deviations and `GATE_LEAST` away. Without a prior or an own pose everything is plausible.
    """
    if prior is None or candidate.position is None:
        return True
    sd = float(np.hypot(prior.position_sd, candidate.sighting.position_sd))
    return norm(candidate.position - prior.position) <= max(GATE_SIGMAS * sd, GATE_LEAST)


def select(candidates: Sequence[Candidate], goal: Vec3 | None) -> Candidate:
    """Choose among several sightings of one target.

        m* = argmin_i f(m_i),   f = ||p_i - p_goal||  if a goal exists,   else  f = -A_i

    `goal` (3,), m, NED, is the place where the target is expected, or failing that the mission's
    goal. Candidates as near as the nearest to within three standard deviations are the same
    place seen through different markers of the target: among them the largest is the sharpest.

    Source: P1 section 5.2.
    """
    if goal is None or any(c.position is None for c in candidates):
        return max(candidates, key=_area)
    gaps = [norm(c.position - goal) for c in candidates if c.position is not None]
    nearest = min(range(len(gaps)), key=gaps.__getitem__)
    slack = candidates[nearest].sighting.position_sd
    level = [
        c
        for c, gap in zip(candidates, gaps, strict=True)
        if gap - gaps[nearest] <= 3.0 * float(np.hypot(slack, c.sighting.position_sd))
    ]
    return max(level, key=_area)


def _area(candidate: Candidate) -> float:
    return candidate.sighting.detection.area
