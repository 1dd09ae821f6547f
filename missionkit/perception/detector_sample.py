"""A picture with its truth, to train detectors and to judge what they find."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from missionkit.geometry import Mat
from missionkit.messages import Image
from missionkit.perception.apparent_size import SizeGate
from missionkit.perception.size_pyramid import Found

AWAY: Final = 0.5  # of an object's width: a window that far from all objects shows none


class Sample(NamedTuple):
    """A picture, and where its objects are."""

    image: Image
    gate: SizeGate
    spans: tuple[float, float]  # px, of widths that are searched for
    places: Mat  # (n, 2), px, of objects that must be found
    others: Mat  # (m, 3), px: middle and radius of what is neither an object nor none


def shows(sample: Sample, place: Mat, width: float) -> bool:
    """Say whether a window shows an object, or what counts neither way.

    Args:
        sample: the picture.
        place: (2,), px, of the window's middle.
        width: px, of an object that it would show.
    """
    to_objects = np.hypot(*(sample.places - place).T)
    to_others = np.hypot(*(sample.others[:, :2] - place).T) - sample.others[:, 2]
    return bool((to_objects < AWAY * width).any() or (to_others < AWAY * width).any())


class Judged(NamedTuple):
    """What was found in one picture, by whether it is an object."""

    right: list[tuple[float, int]]  # margin and windows of each
    wrong: list[tuple[float, int]]
    missed: int


def judged(sample: Sample, found: Sequence[Found]) -> Judged:
    """Return what was found in a picture; what is found of `others` counts neither way.

    Args:
        sample: the picture, and what is in it.
        found: by a detector, the surest first.
    """
    right, wrong, left = [], [], list(range(len(sample.places)))
    for it in found:
        near = [i for i in left if np.hypot(*(sample.places[i] - it.centre)) < AWAY * it.width]
        if near:
            left.remove(near[0])
            right.append((it.margin, it.windows))
        elif not shows(sample, it.centre, it.width):
            wrong.append((it.margin, it.windows))
    return Judged(right, wrong, len(left))
