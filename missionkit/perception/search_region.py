"""Where in a frame a marker may be that would be believed, and whether it could be read there.

A sighting farther from the belief than `marker_selection.plausible` permits is refused, so nothing
is lost by not looking there. The belief is a ball around the target; what a camera sees of a ball
lies between two planes through its centre, in either direction of the image.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Final, NamedTuple

import cv2
import numpy as np

from missionkit.geometry import Transform, norm
from missionkit.messages import CameraModel, Target
from missionkit.perception.aruco import Aruco
from missionkit.perception.marker_selection import GATE_LEAST, GATE_SIGMAS

SIGHT_SD: Final = (
    0.04  # of the distance: more than a sighting that can be read is ever off, 1-sigma
)
MARGIN: Final = 24  # px around the region, so that the border of the cut-out is never seen
MOST: Final = 0.85  # of the image's area, beyond which the whole image is looked at
READABLE: Final = (
    0.85  # of the least side that is read, for markers that appear larger than they are
)


class Region(NamedTuple):
    """A rectangle of an image, px; its right and bottom ends are not part of it."""

    left: int
    top: int
    right: int
    bottom: int

    @property
    def empty(self) -> bool:
        """Nothing can be found there."""
        return self.left >= self.right or self.top >= self.bottom


NOWHERE = Region(0, 0, 0, 0)


class RegionFinder:
    """Predicts where the markers of a mission may appear in the frames of one camera.

    Args:
        camera: intrinsics and mount.
        least_side: px, of the smallest marker that can be read.
    """

    def __init__(self, camera: CameraModel, least_side: float) -> None:
        self._camera = camera
        self._least = READABLE * least_side
        self._whole = Region(0, 0, camera.width, camera.height)
        self._focal = float(max(camera.matrix[0, 0], camera.matrix[1, 1]))
        self._limits = _limits(camera)

    def region(
        self, markers: Iterable[tuple[Aruco, Target | None]], body: Transform | None
    ) -> Region:
        """Return the part of the image in which any of the markers may be; the whole if unsure.

        Args:
            markers: with what is believed of their targets.
            body: body to world at the exposure; None: not known.
        """
        if body is None:
            return self._whole
        world_to_eye = (body @ self._camera.mount).inverse()
        found = NOWHERE
        for marker, target in markers:
            if target is None:
                return self._whole
            found = _around(found, self._of(marker, target, world_to_eye))
        area = (found.right - found.left) * (found.bottom - found.top)
        return self._whole if area > MOST * self._whole.right * self._whole.bottom else found

    def _of(self, marker: Aruco, target: Target, world_to_eye: Transform) -> Region:
        centre = world_to_eye.apply(target.position)
        distance = norm(centre)
        sd = math.hypot(target.position_sd, SIGHT_SD * distance)
        reach = max(GATE_SIGMAS * sd, GATE_LEAST) + marker.size + math.hypot(*marker.offset)
        if distance <= reach:
            return self._whole
        least = max(self._least, READABLE * math.sqrt(marker.min_area))
        if self._focal * marker.size < least * (distance - reach):
            return NOWHERE
        x, y, z = centre.tolist()
        return self._seen(_span(x, z, reach), _span(y, z, reach))

    def _seen(self, across: tuple[float, float], down: tuple[float, float]) -> Region:
        """Return what lies between slopes x/z and y/z, in the image with its distortion."""
        (x0, y0), (x1, y1) = self._limits
        left, right = max(across[0], x0), min(across[1], x1)
        top, bottom = max(down[0], y0), min(down[1], y1)
        if left >= right or top >= bottom:
            return NOWHERE
        xs, ys = np.meshgrid(np.linspace(left, right, 5), np.linspace(top, bottom, 5))
        rays = np.stack([xs, ys, np.ones_like(xs)], axis=-1).reshape(-1, 3)
        camera, still = self._camera, np.zeros(3)
        pixels = cv2.projectPoints(rays, still, still, camera.matrix, camera.distortion)[0]
        low = np.floor(pixels.min(axis=(0, 1))).astype(int) - MARGIN
        high = np.ceil(pixels.max(axis=(0, 1))).astype(int) + MARGIN
        return Region(
            *(max(0, int(low[0])), max(0, int(low[1]))),
            *(min(camera.width, int(high[0])), min(camera.height, int(high[1]))),
        )


def _span(side: float, ahead: float, reach: float) -> tuple[float, float]:
    """Return the least and greatest slope side/ahead of a ball before the camera."""
    away = math.hypot(side, ahead)
    if away <= reach:
        return -math.inf, math.inf
    middle, half = math.atan2(side, ahead), math.asin(reach / away)
    low, high = middle - half, middle + half
    if high <= -math.pi / 2 or low >= math.pi / 2:
        return math.inf, -math.inf
    least = -math.inf if low <= -math.pi / 2 else math.tan(low)
    return least, math.inf if high >= math.pi / 2 else math.tan(high)


def _limits(camera: CameraModel) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the least and the greatest slopes that the image shows."""
    columns, rows = np.linspace(0, camera.width - 1, 9), np.linspace(0, camera.height - 1, 9)
    grid = np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 1, 2)
    slopes = cv2.undistortPoints(grid, camera.matrix, camera.distortion).reshape(-1, 2)
    (left, top), (right, bottom) = slopes.min(axis=0).tolist(), slopes.max(axis=0).tolist()
    return (left, top), (right, bottom)


def _around(one: Region, other: Region) -> Region:
    """Return the rectangle around two."""
    if one.empty or other.empty:
        return other if one.empty else one
    return Region(
        *(min(one.left, other.left), min(one.top, other.top)),
        *(max(one.right, other.right), max(one.bottom, other.bottom)),
    )
