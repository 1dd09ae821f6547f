"""How large an object on the ground appears, and so where and at which sizes it is looked for.

P4 (7), mended: a = f_x A/h and b = f_y B/h. Off the optical axis and with a tilted camera the depth
h is that of the pixel: a ray w (world, 1 along the axis) meets the plane of the object's top, H
below the camera, at depth H/w_z, so that a = f_x A w_z/H, which is linear in the pixel.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from missionkit.geometry import Transform, Vec3, to_matrix
from missionkit.messages import CameraModel

NEAREST: Final = 0.2  # m; nothing is looked for closer than that
LEAST_SIDE: Final = 8.0  # px; a smaller object shows nothing to go by


class SizeGate(NamedTuple):
    """The width of an object by pixel, and how far off it may be."""

    plane: Vec3  # (3,), px: the width is plane @ (column, row, 1)
    aspect: float  # height over width: f_y / f_x
    margin: float  # px, k of P4

    def width(self, column: float, row: float) -> float:
        """Return the expected width (px) at a pixel; at or above the horizon 0 or less."""
        return float(self.plane[0] * column + self.plane[1] * row + self.plane[2])

    def spans(self, camera: CameraModel) -> tuple[float, float] | None:
        """Return the least and the largest width (px) in an image; None: too small everywhere."""
        right, bottom = camera.width - 1.0, camera.height - 1.0
        corners = [self.width(*at) for at in ((0, 0), (right, 0), (right, bottom), (0, bottom))]
        largest = min(max(corners) + self.margin, float(min(camera.width, camera.height)))
        least = max(min(corners) - self.margin, LEAST_SIDE)
        return (least, largest) if least <= largest else None


def size_gate(
    camera: CameraModel,
    body: Transform | None,
    ground: float,
    *,
    diameter: float,
    top: float,
    margin: float,
) -> SizeGate | None:
    """Return the expected size by pixel; None: it is not known or nothing is to be expected.

    The lens's distortion is left out: it changes sizes by less than the margin.

    Args:
        camera: lens and mount.
        body: body to world at the exposure; None: not known.
        ground: m, down, of the ground.
        diameter: m, of the object.
        top: m, of the object's top above the ground.
        margin: px.
    """
    if body is None:
        return None
    eye = body @ camera.mount
    height = ground - top - float(eye.translation[2])
    if not (math.isfinite(height) and height > NEAREST):
        return None
    fx, fy = np.diagonal(camera.matrix)[:2].tolist()
    down = to_matrix(eye.rotation)[2] @ np.linalg.inv(camera.matrix)
    return SizeGate(np.asarray(fx * diameter / height * down), fy / fx, margin)
