"""Features of the ground in camera frames: Harris corners found, and found again.

A known feature is searched where the navigator expects it: its patch, warped as it should look
now, is shifted over the image around that place, and the best correlation counts. No feature
drifts along its path, for the patch stays that of the first sighting.

Sources: P4, II-B; C. Harris and M. Stephens, "A combined corner and edge detector", 1988; active
search: A. Davison, "Real-time simultaneous localisation and mapping with a single camera", 2003.
"""

from __future__ import annotations

import cv2
import numpy as np

from missionkit.geometry import Mat
from missionkit.messages import CameraModel, FeatureMatches, FeatureSearch, Image
from missionkit.messages.image_features import PATCH
from missionkit.perception.opencv_helpers import grey

HALF = PATCH // 2
CORE = 9  # px, half the side of what is compared
LEAST_SCORE = 0.5
"""Normalised correlation from which a patch is found."""
QUALITY, BLOCK, HARRIS_K = 0.01, 5, 0.04
"""A corner's least response (share of the strongest), px of the window, and Harris's k."""


def matched(image: Image, at: float, camera: CameraModel, search: FeatureSearch) -> FeatureMatches:
    """Return which features are found in an image, and new corners.

    Args:
        image: (h, w) grey or (h, w, 3) BGR.
        at: s, of the exposure.
        camera: lens and size.
        search: what to look for.
    """
    picture = grey(image)
    expected = _in_pixels(search.points, camera)
    count = len(expected)
    in_view, found = np.zeros(count, np.bool_), np.zeros(count, np.bool_)
    pixels, patches = expected.copy(), np.zeros((count, PATCH, PATCH), np.uint8)
    for i in range(count):
        reach = int(search.reach[i])
        in_view[i] = _inside(picture, expected[i], reach + CORE + 1)
        if not in_view[i]:
            continue
        place = _found(picture, expected[i], reach, search.patches[i], search.warps[i])
        if place is not None:
            found[i], pixels[i] = True, place
            patches[i] = cv2.getRectSubPix(picture, (PATCH, PATCH), place.tolist())
    wanted = max(search.vacant, search.enough - int(in_view.sum()))
    corners = _corners(picture, pixels, wanted, search.spacing)
    around = [cv2.getRectSubPix(picture, (PATCH, PATCH), each.tolist()) for each in corners]
    return FeatureMatches(
        at,
        in_view,
        found,
        np.where(found[:, None], _ideal(pixels, camera), search.points),
        patches,
        _ideal(corners, camera),
        np.array(around, np.uint8).reshape(-1, PATCH, PATCH),
    )


def _found(picture: Image, expected: Mat, reach: int, patch: Image, warp: Mat) -> Mat | None:
    """Return where a patch is (2,), px, None if it does not look like it anywhere near."""
    side = 2 * CORE + 1
    shift = HALF - warp @ (CORE, CORE)
    core = cv2.warpAffine(
        patch,
        np.column_stack((warp, shift)),
        (side, side),
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_REPLICATE,
    )
    x, y = np.rint(expected).astype(int).tolist()
    span = reach + CORE
    around = picture[y - span : y + span + 1, x - span : x + span + 1]
    scores = cv2.matchTemplate(around, core, cv2.TM_CCOEFF_NORMED)
    _, best, _, (column, row) = cv2.minMaxLoc(scores)
    if not LEAST_SCORE <= best <= 1.01:
        return None
    last = scores.shape[0] - 1
    if not (0 < column < last and 0 < row < last):
        return None
    right = _peak(*scores[row, column - 1 : column + 2].tolist())
    down = _peak(*scores[row - 1 : row + 2, column].tolist())
    return np.array([x - reach + column + right, y - reach + row + down])


def _peak(before: float, middle: float, after: float) -> float:
    """Return where a parabola through three scores is highest, from the middle (px)."""
    bend = before - 2.0 * middle + after
    return 0.5 * (before - after) / bend if bend < 0.0 else 0.0


def _corners(picture: Image, taken: Mat, wanted: int, spacing: float) -> Mat:
    """Return Harris corners (m, 2), px, away from those that are `taken` (n, 2) and the border."""
    if wanted <= 0:
        return np.empty((0, 2))
    free = np.zeros(picture.shape, np.uint8)
    free[HALF + 1 : -HALF - 1, HALF + 1 : -HALF - 1] = 255
    for x, y in np.rint(taken).astype(int).tolist():
        cv2.circle(free, (x, y), round(spacing), 0, -1)
    found = cv2.goodFeaturesToTrack(
        picture,
        wanted,
        QUALITY,
        spacing,
        mask=free,
        blockSize=BLOCK,
        useHarrisDetector=True,
        k=HARRIS_K,
    )
    return np.empty((0, 2)) if found is None else np.asarray(found, np.float64).reshape(-1, 2)


def _inside(picture: Image, place: Mat, margin: int) -> bool:
    rows, columns = picture.shape
    x, y = place.tolist()
    return bool(margin <= x < columns - 1 - margin and margin <= y < rows - 1 - margin)


def _in_pixels(points: Mat, camera: CameraModel) -> Mat:
    """Return where the lens shows points (n, 2) of an ideal camera of focal length 1."""
    if not len(points):
        return np.empty((0, 2))
    rays, still = np.column_stack((points, np.ones(len(points)))), np.zeros(3)
    pixels, _ = cv2.projectPoints(rays, still, still, camera.matrix, camera.distortion)
    return np.asarray(pixels, np.float64).reshape(-1, 2)


def _ideal(pixels: Mat, camera: CameraModel) -> Mat:
    """Return the points (n, 2) of an ideal camera of focal length 1 that pixels (n, 2) show."""
    if not len(pixels):
        return np.empty((0, 2))
    points = cv2.undistortPoints(pixels.reshape(-1, 1, 2), camera.matrix, camera.distortion)
    return np.asarray(points, np.float64).reshape(-1, 2)
