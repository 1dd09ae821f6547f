"""What a navigator asks of an image, and what the image answers."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from missionkit.geometry import Mat

Patches = npt.NDArray[np.uint8]  # (n, 31, 31), grey
PATCH = 31  # px, side of a patch


class FeatureSearch(NamedTuple):
    """Where a navigator expects the features that it knows, in one frame.

    Points are those of an ideal camera of focal length 1: x right, y down.
    """

    slots: npt.NDArray[np.int64]  # (n,), which of the navigator's
    points: Mat  # (n, 2), expected
    reach: Mat  # (n,), px, how far from there each is searched
    warps: Mat  # (n, 2, 2), px of the patch for one px of this frame
    patches: Patches  # around each feature when it was first seen, or last kept
    vacant: int  # how many new corners it has room for
    enough: int  # how many it wants in view, at the cost of those that are not
    spacing: float  # px, least distance of a new corner from all others


class FeatureMatches(NamedTuple):
    """What was found in one frame. Points as in `FeatureSearch`."""

    at: float  # s, of the exposure
    in_view: npt.NDArray[np.bool_]  # (n,), the whole place of search is in the image
    found: npt.NDArray[np.bool_]  # (n,)
    points: Mat  # (n, 2), where; the expected point where nothing was found
    patches: Patches  # (n, 31, 31), what surrounds it now
    corners: Mat  # (m, 2), new ones
    corner_patches: Patches  # (m, 31, 31)
