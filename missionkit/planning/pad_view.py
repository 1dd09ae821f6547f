"""From where a landing pad is sure to be in view, however wrong its place may be.

Source: P3 section VI-B, correction P3.6.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.geometry import to_matrix
from missionkit.messages import CameraModel

REACTION = 0.3  # s, until a sighting has changed the velocity


class ViewCone(NamedTuple):
    """The cone below a camera that is certainly in view, and how the vehicle moves in it."""

    half_angle: float  # rad, φ, about the vertical
    sigmas: float  # k, standard deviations of the pad's place that are allowed for
    descent: float  # m/s, v_d
    acceleration: float  # m/s², a, level
    least: float = 0.0  # m, h_min


def deviation_height(cone: ViewCone, sd: float) -> float:
    """Return the height (m) above a pad to be kept until it is in view.

        h_1 = max(k σ / tan φ,  v_d (0.3 s + 2 sqrt(k σ / a)),  h_min)

    High enough that the view covers an error of k σ, and that the error can still be flown off
    (there and to rest again at the acceleration a) while descending.

    Args:
        cone: of the camera and the vehicle.
        sd: σ, of the pad's place relative to the vehicle (m, one axis).
    """
    error = cone.sigmas * sd
    seen = error / math.tan(cone.half_angle)
    corrected = cone.descent * (REACTION + 2.0 * math.sqrt(error / cone.acceleration))
    return max(seen, corrected, cone.least)


def entry_radius(cone: ViewCone, sd: float, height: float) -> float:
    """Return how near (m, level) to the pad its estimate must be for it to be in view.

    h tan φ - k σ at a height h; 0 where the view does not cover the error at all.

    Args:
        cone: of the camera and the vehicle.
        sd: σ, of the pad's place relative to the vehicle (m, one axis).
        height: above the pad, m.
    """
    return max(0.0, height * math.tan(cone.half_angle) - cone.sigmas * sd)


def cone_below(camera: CameraModel) -> float:
    """Return the half angle (rad) of the widest cone about the vertical that is in view.

    Of a level vehicle; the planes through the image's edges bound what is seen. Distortion is left
    out: a lens that bends its edges outwards sees more. Negative if it does not see straight down.

    Args:
        camera: of the mission.
    """
    down = to_matrix(camera.mount.rotation).T @ np.array((0.0, 0.0, 1.0))
    rays = np.linalg.solve(camera.matrix, _corners(camera)).T  # (4, 3), clockwise
    edges = np.cross(rays, np.roll(rays, -1, axis=0))  # inward normals
    inward = edges / np.linalg.norm(edges, axis=1, keepdims=True)
    return float(np.arcsin(np.clip(inward @ down, -1.0, 1.0)).min())


def _corners(camera: CameraModel) -> np.ndarray:
    """Return the image's corners (3, 4), px, homogeneous, clockwise from the top left."""
    right, low = camera.width - 0.5, camera.height - 0.5
    return np.array(((-0.5, right, right, -0.5), (-0.5, -0.5, low, low), (1.0, 1.0, 1.0, 1.0)))
