"""Plates of obstacle robots in an image: the inner ends of its bright parts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np

from missionkit.geometry import Mat
from missionkit.messages import CameraModel, Image
from missionkit.perception.apparent_size import SizeGate
from missionkit.perception.blob_search import Mask, of_contrast

LEAST_FILL: Final = 0.45  # bright share of a plate's inner half; its tower hides the outer one
WIDTHS: Final = (0.55, 1.6)  # of a plate across the line from below the camera, in sizes
SAME_LINE: Final = 0.8  # sizes, across, of a tower's top off the line through its plate
TOPS: Final = (1.15, 4.0)  # times as far from below the camera as its plate is a tower's top


class Plate(NamedTuple):
    """The plate of an obstacle robot."""

    centre: Mat  # (2,), px
    width: float  # px
    score: float


def bright(image: Image, contrast: float, largest: float) -> Mask:
    """Return what is brighter than its surroundings.

    Args:
        image: grey or BGR.
        contrast: grey levels.
        largest: px, width of a plate.
    """
    return of_contrast(np.asarray(cv2.blur(image, (3, 3)), np.uint8), 1.0, contrast, largest)


def below(camera: CameraModel, gate: SizeGate) -> Mat:
    """Return the pixel (2,) straight below the camera: where the gate's plane is steepest.

    Args:
        camera: its lens.
        gate: whose plane is a multiple of e3ᵀ R K⁻¹.
    """
    pixel = camera.matrix @ (camera.matrix.T @ gate.plane)
    return np.asarray(pixel[:2] / pixel[2], np.float64)


def plates(mask: Mask, gate: SizeGate, nadir: Mat) -> list[Plate]:
    """Return the plates among the bright parts of an image, the nearest to below the camera first.

    Args:
        mask: where an image is bright.
        gate: the expected width of a plate by pixel.
        nadir: (2,), px, straight below the camera.
    """
    found = sorted(_parts(mask, gate, nadir), key=lambda it: math.dist(it.centre, nadir))
    kept: list[Plate] = []
    for it in found:
        if not _is_top(it, kept, nadir):
            kept.append(it)
    return kept


def _parts(mask: Mask, gate: SizeGate, nadir: Mat) -> Iterator[Plate]:
    count, labels, parts, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8))
    least = 0.3 * gate.width(*nadir.tolist()) ** 2
    for number in range(1, count):
        left, top, width, height, area = parts[number].tolist()
        if area < least:
            continue
        rows, columns = np.nonzero(labels[top : top + height, left : left + width] == number)
        pixels = np.column_stack([columns + left, rows + top]).astype(np.float64)
        found = _inner_end(pixels, mask, gate, nadir)
        if found is not None:
            yield found


def _inner_end(pixels: Mat, mask: Mask, gate: SizeGate, nadir: Mat) -> Plate | None:
    """Return the plate at the end of a bright part (n, 2), px, next to below the camera."""
    far = np.hypot(*(pixels - nadir).T)
    size = gate.width(*pixels[far.argmin()].tolist())
    end = pixels[far <= far.min() + size]
    out = end.mean(axis=0) - nadir
    along = out / max(float(np.hypot(*out)), 1e-9)
    centre = nadir + (out if far.min() < 1.0 else (far.min() + 0.5 * size) * along)
    across = (end - centre) @ np.array([-along[1], along[0]])
    spread = float(across.max() - across.min()) + 1.0
    if not WIDTHS[0] * size <= spread <= WIDTHS[1] * size or not _whole(centre, size, mask):
        return None
    off = end - centre
    inner = (np.hypot(*off.T) <= 0.45 * size) & (off @ along <= 0.0)
    fill = 2.0 * np.count_nonzero(inner) / (math.pi * (0.45 * size) ** 2)
    return Plate(centre, size, min(fill, 1.0)) if fill >= LEAST_FILL else None


def _whole(centre: Mat, size: float, mask: Mask) -> bool:
    """Say whether a plate is not cut by the image's edge."""
    rows, columns = mask.shape
    half = 0.4 * size
    column, row = float(centre[0]), float(centre[1])
    return bool(half <= column <= columns - 1 - half and half <= row <= rows - 1 - half)


def _is_top(it: Plate, others: Sequence[Plate], nadir: Mat) -> bool:
    """Say whether a bright spot is the top of a tower whose plate is another one."""
    out = it.centre - nadir
    for other in others:
        inner = other.centre - nadir
        gap = max(float(np.hypot(*inner)), 1e-9)
        across = abs(float(inner[0] * out[1] - inner[1] * out[0])) / gap
        times = float(inner @ out) / gap**2
        if across <= SAME_LINE * other.width and TOPS[0] <= times <= TOPS[1]:
            return True
    return False
