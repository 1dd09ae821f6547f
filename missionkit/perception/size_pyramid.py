"""An image at the sizes at which objects fill a small window, and what was found in it.

Shared by the detectors that slide a window of one size over the image.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np

from missionkit.geometry import Mat
from missionkit.messages import BoxDetection, CameraModel, Image
from missionkit.perception.score_law import ScoreLaw

LEAST_SD: Final = 3.0  # grey levels; a flatter window shows nothing
STEP: Final = 1.15  # between sizes
RIM: Final = 2  # px around an image, beyond what a window has around its object
APART: Final = 0.5  # of an object's width: what was found nearer is the same object


class Level(NamedTuple):
    """An image at the size at which objects of a certain width fill the window."""

    image: Image  # with a rim of `pad` on each side
    width: float  # px, of the objects, in the full image
    scale: tuple[float, float]  # px of this image by px of the full one, across and down
    pad: int  # px

    def windows_at(self, place: Mat, side: int) -> tuple[int, int]:
        """Return left and top of the window nearest to a place of the full image."""
        left, top = (
            round((at + 0.5) * scale - 0.5 * side) + self.pad
            for at, scale in zip(place.tolist(), self.scale, strict=True)
        )
        return left, top


class Found(NamedTuple):
    """One object, by all windows that show it."""

    centre: Mat  # (2,), px
    width: float  # px
    margin: float  # best sum over what the stages ask for
    windows: int


def widths(least: float, largest: float) -> Iterator[float]:
    """Yield widths (px) about `STEP` apart that cover a range."""
    ratio = largest / least
    count = max(1, round(math.log(ratio) / math.log(STEP)))
    for i in range(count):
        yield least * ratio ** ((i + 0.5) / count)


def level_of(image: Image, width: float, aspect: float, inner: float, side: int) -> Level:
    """Return an image at the size where an object `width` wide is `inner` px wide.

    Args:
        image: (h, w), grey.
        width: px, of the object.
        aspect: its height over its width.
        inner: px, of the object in the window.
        side: px, of the window.
    """
    rows, columns = image.shape
    size = (
        max(1, round(columns * inner / width)),
        max(1, round(rows * inner / (width * aspect))),
    )
    pad = math.ceil(0.5 * (side - inner)) + RIM
    how = cv2.INTER_AREA if size[0] < columns else cv2.INTER_LINEAR
    small = cv2.resize(image, size, interpolation=how)
    framed = cv2.copyMakeBorder(small, pad, pad, pad, pad, cv2.BORDER_REPLICATE)
    return Level(np.asarray(framed, np.uint8), width, (size[0] / columns, size[1] / rows), pad)


def grouped(windows: Mat) -> list[Found]:
    """Return one object for all windows near to each other, the surest first.

    Args:
        windows: (n, 4), column, row, width (px), margin.
    """
    left, found = windows[np.argsort(-windows[:, 3], kind="stable")], []
    while len(left):
        best = left[0]
        near = np.hypot(*(left[:, :2] - best[:2]).T) < APART * best[2]
        group, left = left[near], left[~near]
        share = group[:, 3] + 1e-3
        mean = share @ group[:, :3] / share.sum()
        found.append(Found(mean[:2], float(mean[2]), float(best[3]), len(group)))
    return found


def boxes_of(
    found: Sequence[Found],
    law: ScoreLaw,
    aspect: float,
    camera: CameraModel,
    detector: str,
    kind: str,
) -> Iterator[BoxDetection]:
    """Yield a box around each object whose middle is in the image.

    Args:
        found: objects.
        law: of their scores.
        aspect: their height over their width.
        camera: whose image it is.
        detector: that found them.
        kind: of object.
    """
    for it in found:
        column, row = it.centre.tolist()
        if -0.5 <= column < camera.width - 0.5 and -0.5 <= row < camera.height - 0.5:
            score = law.score(it.margin, it.windows)
            size = it.width, it.width * aspect
            yield BoxDetection(detector, it.centre, size, score, kind, sized=False)
