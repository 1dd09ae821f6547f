"""Searching an image for windows that a cascade passes."""

from __future__ import annotations

from typing import Final

import numpy as np

from missionkit.geometry import Mat
from missionkit.messages import Image
from missionkit.perception.apparent_size import SizeGate
from missionkit.perception.haar.cascade import CascadeArrays
from missionkit.perception.size_pyramid import LEAST_SD, Found, Level, grouped, level_of, widths

STRIDE: Final = 2  # px, of a window that is SIDE wide
MOST_WINDOWS: Final = 4000


def passing(level: Level, arrays: CascadeArrays, side: int, gate: SizeGate, stride: int) -> Mat:
    """Return the windows that pass, (n, 3): column, row (px of the full image), margin.

    Args:
        level: the image at one size.
        arrays: the cascade.
        side: px, of its window.
        gate: which width is searched for where.
        stride: px, between windows.
    """
    from missionkit.perception.haar.kernels import integrated, search  # noqa: PLC0415 compiles

    sums, squares = integrated(level.image)
    out = np.empty((MOST_WINDOWS, 3))
    place = np.array([*gate.plane, *level.scale])
    count = search(
        sums, squares, side, *arrays, place, level.width, gate.margin, stride, level.pad,
        LEAST_SD, out,
    )  # fmt: skip
    return out[:count]


def objects(
    image: Image,
    arrays: CascadeArrays,
    side: int,
    inner: float,
    gate: SizeGate,
    spans: tuple[float, float],
    stride: int = STRIDE,
) -> list[Found]:
    """Return the objects in an image.

    Args:
        image: (h, w), grey.
        arrays: the cascade.
        side: px, of its window.
        inner: px, of the object in the window.
        gate: which width is searched for where.
        spans: px, least and largest width.
        stride: px, between windows.
    """
    parts = []
    for width in widths(*spans):
        level = level_of(image, width, gate.aspect, inner, side)
        windows = passing(level, arrays, side, gate, stride)
        sized = np.column_stack([windows[:, :2], np.full(len(windows), width), windows[:, 2]])
        parts.append(sized)
    return grouped(np.vstack(parts))
