"""The lens of a camera, from views of a ChArUco board."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from missionkit.messages import Image
from missionkit.perception.imaging import dictionary, grey

LEAST_VIEWS = 8
LEAST_CORNERS = 8
LEAST_MOVED = 0.02
"""Share of the image's width by which the corners of two views must differ."""


@dataclass(frozen=True, slots=True)
class Lens:
    """An OpenCV calibration: `matrix` (3, 3), `distortion` (5,), and how well it fits."""

    width: int
    height: int
    matrix: Any
    distortion: Any
    error: float  # px, root mean square
    views: int


@dataclass(frozen=True, slots=True)
class View:
    """Corners of the board in one image: `ids` (N,), `pixels` (N, 2)."""

    width: int
    height: int
    ids: Any
    pixels: Any


def board(columns: int, rows: int, square: float, marker: float, name: str) -> Any:
    """Return the board; `square` and `marker` are edges in metres.

    Raises:
        ValueError: such a board cannot be.
    """
    if min(columns, rows) < 3 or not 0 < marker < square:
        raise ValueError("a board has at least 3x3 squares, and its markers are smaller than these")
    return cv2.aruco.CharucoBoard((columns, rows), square, marker, dictionary(name))


def view(image: Image, board: Any) -> View | None:
    """Return the corners of the board in an image, None if it shows too few of them."""
    plain = grey(image)
    pixels, ids, _, _ = cv2.aruco.CharucoDetector(board).detectBoard(plain)
    if ids is None or len(ids) < LEAST_CORNERS:
        return None
    return View(plain.shape[1], plain.shape[0], np.ravel(ids), np.reshape(pixels, (-1, 2)))


def different(views: Sequence[View]) -> list[View]:
    """Return the views that differ from each one kept before."""
    kept: list[View] = []
    for it in views:
        if all(_moved(it, other) >= LEAST_MOVED * it.width for other in kept):
            kept.append(it)
    return kept


def calibrate(views: Sequence[View], board: Any) -> Lens:
    """Return the lens that explains the views.

    Raises:
        ValueError: the views are too few, too similar, or of several sizes.
    """
    if len(views) < LEAST_VIEWS:
        raise ValueError(f"the board is seen in {len(views)} images; {LEAST_VIEWS} are needed")
    if len({(it.width, it.height) for it in views}) > 1:
        raise ValueError("the images are of several sizes; all must come from one camera")
    kept = different(views)
    if len(kept) < LEAST_VIEWS:
        raise ValueError(
            f"only {len(kept)} of {len(views)} views differ; {LEAST_VIEWS} are needed: "
            "move and tilt the board between them"
        )
    size = (kept[0].width, kept[0].height)
    corners = np.asarray(board.getChessboardCorners(), np.float32)
    error, matrix, distortion, _, _ = cv2.calibrateCamera(
        [corners[it.ids] for it in kept],
        [np.asarray(it.pixels, np.float32) for it in kept],
        size,
        np.eye(3),
        np.zeros(5),
    )
    return Lens(*size, matrix, np.ravel(distortion)[:5], float(error), len(kept))


def detector(name: str) -> Any:
    """Return OpenCV's detector of the markers of a dictionary.

    Raises:
        ValueError: there is no such dictionary.
    """
    return cv2.aruco.ArucoDetector(dictionary(name))


def read(path: str) -> Image | None:
    """Return the image in a file, None if there is none."""
    image = cv2.imread(path) if Path(path).is_file() else None
    return None if image is None else np.asarray(image, np.uint8)


def draw(path: Path, image: Image, corners: Any, ids: Any) -> bool:
    """Write the image with the markers drawn in; False if that cannot be."""
    try:
        picture = cv2.aruco.drawDetectedMarkers(image.copy(), corners, ids)
        return bool(cv2.imwrite(str(path), picture))
    except cv2.error:  # no such kind of picture
        return False


def _moved(one: View, other: View) -> float:
    """Return by how many pixels the corners that both show differ, infinite if none is shared."""
    _, first, second = np.intersect1d(one.ids, other.ids, return_indices=True)
    if not len(first):
        return float("inf")
    return float(np.linalg.norm(one.pixels[first] - other.pixels[second], axis=1).mean())
