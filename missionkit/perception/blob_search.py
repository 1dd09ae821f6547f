"""Connected parts of an image that stand out, are round, and as large as expected."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final, NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from missionkit.geometry import Mat
from missionkit.messages import Image
from missionkit.perception.apparent_size import SizeGate
from missionkit.perception.opencv_helpers import grey

SURROUNDINGS: Final = 3.0  # sizes of an object, over which the ground's brightness is averaged
LEAST_FILL: Final = 0.55  # share of its box that a round object fills: π/4, less what is lost

Mask = npt.NDArray[np.bool_]  # (height, width)


class Colour(NamedTuple):
    """Colours about a hue."""

    hue_deg: float  # 0 red, 120 green, 240 blue
    within_deg: float
    saturation: float  # least, 0 to 1


def of_colour(image: Image, colour: Colour, least: float) -> Mask:
    """Return where an image is of a colour.

    Args:
        image: BGR.
        colour: that is looked for.
        least: grey levels, of the brightness.
    """
    hue, saturation, value = cv2.split(cv2.cvtColor(image, cv2.COLOR_BGR2HSV))
    off = np.abs((hue * 2.0 - colour.hue_deg + 180.0) % 360.0 - 180.0)
    vivid = (saturation >= 255.0 * colour.saturation) & (value > least)
    return np.asarray((off <= colour.within_deg) & vivid)


def of_contrast(image: Image, sign: float, least: float, largest: float) -> Mask:
    """Return where an image differs from what is around.

    Args:
        image: grey or BGR.
        sign: 1: where it is brighter; -1: darker.
        least: grey levels.
        largest: px, width of an object.
    """
    flat = grey(image).astype(np.float32)
    side = 2 * math.ceil(0.5 * SURROUNDINGS * largest) + 1
    return np.asarray(sign * (flat - cv2.blur(flat, (side, side))) >= least)


class _Part(NamedTuple):
    """A connected part of a mask: OpenCV's row of it, px."""

    left: int
    top: int
    width: int
    height: int
    area: int


def round_parts(mask: Mask, gate: SizeGate) -> Iterator[tuple[Mat, tuple[float, float], float]]:
    """Yield centre (px), size (px) and score of the parts that may be an object.

    Args:
        mask: where an image stands out.
        gate: the expected width by pixel.
    """
    opened = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
    _, _, parts, middles = cv2.connectedComponentsWithStats(opened, connectivity=4)
    for row, middle in zip(parts[1:].tolist(), middles[1:], strict=True):
        it = _Part(*row)
        expected = gate.width(*middle.tolist())
        off = max(abs(it.width - expected), abs(it.height / gate.aspect - expected))
        fill = it.area / (it.width * it.height)
        if expected > 0.0 and off <= gate.margin and fill >= LEAST_FILL and _whole(it, mask):
            score = min(fill / (0.25 * math.pi), 1.0) * (1.0 - 0.5 * off / (gate.margin + 1.0))
            yield np.asarray(middle, np.float64), (float(it.width), float(it.height)), score


def _whole(it: _Part, mask: Mask) -> bool:
    """Say whether a part is not cut by the image's edge."""
    rows, columns = mask.shape
    return min(it.left, it.top) > 0 and it.left + it.width < columns and it.top + it.height < rows
