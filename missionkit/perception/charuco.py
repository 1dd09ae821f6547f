"""A ChArUco board: how it is printed, and where its corners are in an image."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import cv2
import numpy as np

from missionkit.messages import Image
from missionkit.perception.opencv_helpers import dictionary, grey

LEAST_CORNERS: Final = 8
LEAST_MOVED: Final = 0.02
"""Share of the image's width by which the corners of two views must differ."""

DOTS: Final = 12_000  # a metre of paper, 305 an inch
MARGIN: Final = 0.005  # m, white
_AFTER_HEADER: Final = 33  # bytes of a PNG file: signature and IHDR


@dataclass(frozen=True, slots=True)
class View:
    """Corners of the board in one image: `ids` (N,), `pixels` (N, 2)."""

    width: int
    height: int
    ids: Any
    pixels: Any


def board(columns: int, rows: int, square: float, marker: float, name: str) -> Any:
    """Return the board; `square` and `marker` are edges in metres.

    Args:
        columns: squares across.
        rows: squares down.
        square: edge, m.
        marker: edge, m, less than `square`.
        name: of the dictionary.

    Raises:
        ValueError: such a board cannot be.
    """
    if min(columns, rows) < 3 or not 0 < marker < square:
        raise ValueError("a board has at least 3x3 squares, and its markers are smaller than these")
    markers = dictionary(name)
    known, needed = len(markers.bytesList), columns * rows // 2
    if needed > known:
        raise ValueError(f"{columns}x{rows} squares need {needed} markers; {name} has {known}")
    return cv2.aruco.CharucoBoard((columns, rows), square, marker, markers)


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


def printed(board: Any) -> bytes:
    """Return a PNG file that prints the board in its true size, with a white margin.

    Raises:
        ValueError: the board is larger than 3 m.
    """
    columns, rows = board.getChessboardSize()
    square = round(board.getSquareLength() * DOTS)
    if max(columns, rows) * square > 3 * DOTS:
        raise ValueError("a board of more than 3 m is not drawn; squares are given in metres")
    margin = round(MARGIN * DOTS)
    size = (columns * square + 2 * margin, rows * square + 2 * margin)
    data = bytes(cv2.imencode(".png", board.generateImage(size, marginSize=margin))[1])
    chunk = b"pHYs" + struct.pack(">IIB", DOTS, DOTS, 1)
    scale = struct.pack(">I", 9) + chunk + struct.pack(">I", zlib.crc32(chunk))
    return data[:_AFTER_HEADER] + scale + data[_AFTER_HEADER:]


def _moved(one: View, other: View) -> float:
    """Return by how many pixels the corners that both show differ, infinite if none is shared."""
    _, first, second = np.intersect1d(one.ids, other.ids, return_indices=True)
    if not len(first):
        return float("inf")
    return float(np.linalg.norm(one.pixels[first] - other.pixels[second], axis=1).mean())
