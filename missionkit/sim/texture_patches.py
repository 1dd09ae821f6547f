"""Convex pieces of a picture, and textures warped into them.

Pixel centres lie at integer coordinates: a texture of n texels spans -0.5 to n - 0.5.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from missionkit.geometry import Mat
from missionkit.messages import Image

WASTE = 25_000  # px², a patch that would draw more than this in vain is split
LINEAR: int = cv2.INTER_LINEAR

Polygon = list[tuple[float, float]]  # convex, px
Rectangle = tuple[int, int, int, int]  # left, top, right, bottom, px


def clip(polygon: Polygon, line: Sequence[float]) -> Polygon:
    """Return the part of a convex polygon where line · (u, v, 1) >= 0.

    Source: Sutherland and Hodgman, 1974.
    """
    a, b, c = line
    sides = [a * x + b * y + c for x, y in polygon]
    if not polygon or min(sides) >= 0:
        return polygon
    kept: Polygon = []
    q, before = polygon[-1], sides[-1]
    for p, side in zip(polygon, sides, strict=True):
        if (before < 0) != (side < 0):
            t = before / (before - side)
            kept.append((q[0] + t * (p[0] - q[0]), q[1] + t * (p[1] - q[1])))
        if side >= 0:
            kept.append(p)
        q, before = p, side
    return kept


class Patch(NamedTuple):
    """A rectangle of the canvas and how much of each pixel a polygon covers."""

    x: int
    y: int
    target: Image  # a window on the canvas
    mask: Image  # 0 to 255

    def lay(self, drawn: Image) -> None:
        """Lay a picture of the patch's size on the canvas, with soft edges."""
        over = cv2.multiply(drawn, self.mask, scale=1 / 255)
        under = cv2.multiply(self.target, cv2.bitwise_not(self.mask), scale=1 / 255)
        cv2.add(over, under, dst=self.target)


def patches_of(canvas: Image, polygon: Polygon) -> list[Patch]:
    """Return patches that together cover a convex polygon, which may touch the canvas's rim."""
    if len(polygon) < 3:
        return []
    columns, rows = zip(*polygon, strict=True)
    left, top = max(0, math.floor(min(columns))), max(0, math.floor(min(rows)))
    right = min(canvas.shape[1], math.ceil(max(columns)) + 2)
    bottom = min(canvas.shape[0], math.ceil(max(rows)) + 2)
    whole = np.array([(round(16 * u), round(16 * v)) for u, v in polygon], np.int32)
    return [
        _patch(canvas, whole, rectangle)
        for rectangle in _split(polygon, (left, top, right, bottom))
    ]


def _split(polygon: Polygon, rectangle: Rectangle) -> list[Rectangle]:
    """Halve a rectangle until its pieces are well filled by the polygon."""
    left, top, right, bottom = rectangle
    width, height = right - left, bottom - top
    if width <= 0 or height <= 0 or not polygon:
        return []
    if width * height - area_of(polygon) < WASTE:
        return [rectangle]
    if width > height:
        x = left + width // 2
        low, high = clip(polygon, (-1, 0, x)), clip(polygon, (1, 0, -x))
        cuts = (left, top, x, bottom), (x, top, right, bottom)
    else:
        y = top + height // 2
        low, high = clip(polygon, (0, -1, y)), clip(polygon, (0, 1, -y))
        cuts = (left, top, right, y), (left, y, right, bottom)
    return [*_tight(low, cuts[0]), *_tight(high, cuts[1])]


def _tight(polygon: Polygon, rectangle: Rectangle) -> list[Rectangle]:
    """Shrink a rectangle to what the polygon touches, then split it further."""
    if not polygon:
        return []
    columns, rows = zip(*polygon, strict=True)
    left, top, right, bottom = rectangle
    left, top = max(left, math.floor(min(columns)) - 1), max(top, math.floor(min(rows)) - 1)
    right = min(right, math.ceil(max(columns)) + 2)
    bottom = min(bottom, math.ceil(max(rows)) + 2)
    return _split(polygon, (left, top, right, bottom))


def _patch(canvas: Image, sixteenths: npt.NDArray[np.int32], rectangle: Rectangle) -> Patch:
    left, top, right, bottom = rectangle
    target = canvas[top:bottom, left:right]
    mask = np.zeros(target.shape, np.uint8)
    corners = sixteenths - np.array([16 * left, 16 * top], np.int32)
    cv2.fillConvexPoly(mask, corners, 255, cv2.LINE_AA, shift=4)
    return Patch(left, top, target, mask)


def area_of(polygon: Polygon) -> float:
    """Return the area (px²) of a polygon."""
    twice = 0.0
    a, b = polygon[-1] if polygon else (0.0, 0.0)
    for x, y in polygon:
        twice += a * y - x * b
        a, b = x, y
    return 0.5 * abs(twice)


def warp(
    texture: Image, back: Mat, patch: Patch, border: int, factor: int = 1, how: int = LINEAR
) -> Image:
    """Return the texture as seen in a patch; `back` maps canvas pixels to the unit square.

    Args:
        texture: (h, w), grey.
        back: (3, 3) homography.
        patch: part of the canvas.
        border: what lies outside the texture, as OpenCV names it.
        factor: of oversampling.
        how: interpolation, as OpenCV names it.
    """
    height, width = patch.target.shape
    drawn = cv2.warpPerspective(
        texture,
        _texels(texture, back, patch, factor),
        (width * factor, height * factor),
        flags=how | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_CONSTANT,
        borderValue=border,
    )
    if factor > 1:
        drawn = cv2.resize(drawn, (width, height), interpolation=cv2.INTER_AREA)
    return np.asarray(drawn, np.uint8)


def _texels(texture: Image, back: Mat, patch: Patch, factor: int) -> Mat:
    """Return the homography from (sub)pixels of a patch to texels."""
    rows, columns = texture.shape
    across, down, depth = back.tolist()
    shift = 0.5 / factor - 0.5
    x, y = patch.x + shift, patch.y + shift
    texels = []
    for a, b, c in (
        [columns * p - 0.5 * w for p, w in zip(across, depth, strict=True)],
        [rows * p - 0.5 * w for p, w in zip(down, depth, strict=True)],
        depth,
    ):
        texels.append((a / factor, b / factor, c + (x * a + y * b)))
    return np.array(texels)
