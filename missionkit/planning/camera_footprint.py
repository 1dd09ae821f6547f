"""What a camera that looks down sees of level ground."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.geometry import to_matrix
from missionkit.messages import CameraModel

LEAST_DEPTH = 0.17  # sine of 10 deg: a ray that is flatter sees the horizon rather than the ground


class Footprint(NamedTuple):
    """The part of level ground that is in every picture, of a vehicle that flies forward."""

    across: float  # m, to both sides, where it is narrowest
    along: float  # m, where it is shortest
    pixel: float  # m, ground sample distance in the middle of the picture


def footprint(camera: CameraModel, height: float) -> Footprint | None:
    """Return what a level vehicle sees of the ground, None if the horizon is in the picture.

    A camera that is tilted or panned sees a quadrangle: of its sides those count that lie further
    in. Distortion is left out.

    Args:
        camera: lens and mount.
        height: m, above the ground, more than 0.
    """
    right, low = camera.width - 0.5, camera.height - 0.5
    corners = np.array(((-0.5, right, right, -0.5), (-0.5, -0.5, low, low), (1.0, 1.0, 1.0, 1.0)))
    body = to_matrix(camera.mount.rotation)
    rays = body @ np.linalg.solve(camera.matrix, corners)
    rays /= np.linalg.norm(rays, axis=0)
    if rays[2].min() < LEAST_DEPTH:
        return None
    forward, aside = height * rays[:2] / rays[2]
    (_, left, inner_right, _), (_, back, front, _) = np.sort(aside), np.sort(forward)
    middle = body @ np.linalg.solve(camera.matrix, (0.5 * (right - 0.5), 0.5 * (low - 0.5), 1.0))
    distance = height * float(np.linalg.norm(middle)) / float(middle[2])
    focal = math.sqrt(camera.matrix[0, 0] * camera.matrix[1, 1])
    return Footprint(float(inner_right - left), float(front - back), distance / focal)
