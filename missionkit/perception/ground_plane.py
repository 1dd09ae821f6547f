"""From a box in the image to a place on level ground, with all that makes the place uncertain.

The inverse of P4 (8) to (14). A pixel's ray w (world) meets the ground, h below the camera, at

    p = c + (h / w_z) w,   horizontally,   and   R = J_px R_px J_pxᵀ + J_c P_c J_cᵀ + J_θ P_θ J_θᵀ

with the covariances of pixel, camera position c and attitude. The vehicle's own errors shift all
that one frame shows alike; they are counted as if each object had its own.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import cv2
import numpy as np

from missionkit.geometry import Mat, Transform, Vec3, rotate, skew, to_matrix
from missionkit.messages import BoxDetection, CameraModel, GroundDetection

LEAST_SLOPE: Final = math.tan(math.radians(10.0))
"""A ray that falls less steeply meets the ground nowhere in particular."""


class ViewNoise(NamedTuple):
    """Standard deviations of what places a pixel on the ground."""

    pixel: float = 1.5  # px, each axis, of a box's centre
    position: float = 0.0  # m, the vehicle's, horizontally, each axis
    height: float = 0.0  # m, of the camera above the ground
    attitude: float = 0.0  # rad, the vehicle's, about each axis


def on_ground(
    box: BoxDetection,
    camera: CameraModel,
    body: Transform,
    ground: float,
    noise: ViewNoise,
    diameter: float,
    top: float = 0.0,
) -> GroundDetection | None:
    """Return where a box's object stands on level ground; None: it does not meet it.

    Args:
        box: in the image.
        camera: lens and mount.
        body: body to world at the exposure.
        ground: m, down, of the ground.
        noise: of pixels and the vehicle's pose.
        diameter: m, of a ground robot.
        top: m above the ground, of what the box's centre shows.
    """
    eye = body @ camera.mount
    ray = _ray(box.centre, camera)
    w = rotate(eye.rotation, ray)
    height = ground - float(eye.translation[2])
    if not (height > top and w[2] > LEAST_SLOPE * math.hypot(w[0], w[1])):
        return None
    depth = (height - top) / float(w[2])  # m along the optical axis, since the ray is 1 there
    away = depth * w[:2]
    f = np.diagonal(camera.matrix)[:2]
    seen = max(box.size[0] / f[0], box.size[1] / f[1])
    return GroundDetection(
        detector=box.detector,
        position=eye.translation[:2] + away,
        covariance=_covariance(w, depth, to_matrix(eye.rotation)[:, :2] / f, noise),
        score=box.score,
        size=float(seen * depth / diameter),  # P4 (7): a = f_x A / h
        offset=float(math.hypot(*away)),
        height=height,
        kind=box.kind,
        id=box.id,
        sized=box.sized,
    )


def _covariance(w: Vec3, depth: float, from_pixel: Mat, noise: ViewNoise) -> Mat:
    """Return the covariance (2, 2), m², of a place on the ground.

    Args:
        w: (3,), the ray in the world.
        depth: how often it must be taken to reach the ground.
        from_pixel: (3, 2), derivative of w by the pixel.
        noise: standard deviations.
    """
    slope = w[:2] / w[2]
    to_place = depth * np.column_stack((np.eye(2), -slope))  # (2, 3), of the place by w
    by_pixel = to_place @ from_pixel * noise.pixel
    by_attitude = to_place @ skew(w) * noise.attitude
    by_height = slope * noise.height
    return np.asarray(
        by_pixel @ by_pixel.T
        + by_attitude @ by_attitude.T
        + np.outer(by_height, by_height)
        + noise.position**2 * np.eye(2)
    )


def view_of(camera: CameraModel, body: Transform, ground: float) -> Mat | None:
    """Return the corners (4, 2), m, of the ground that a camera shows; None: it sees the horizon.

    Args:
        camera: lens and mount.
        body: body to world.
        ground: m, down, of the ground.
    """
    eye = body @ camera.mount
    right, bottom = camera.width - 1.0, camera.height - 1.0
    corners = []
    for pixel in ((0.0, 0.0), (right, 0.0), (right, bottom), (0.0, bottom)):
        w = rotate(eye.rotation, _ray(np.array(pixel), camera))
        height = ground - float(eye.translation[2])
        if not (height > 0.0 and w[2] > LEAST_SLOPE * math.hypot(w[0], w[1])):
            return None
        corners.append(eye.translation[:2] + height / w[2] * w[:2])
    return np.array(corners)


def _ray(pixel: Mat, camera: CameraModel) -> Vec3:
    """Return the direction (3,) of a pixel (2,) in the camera's frame, 1 along its axis."""
    straight = cv2.undistortPoints(pixel.reshape(1, 1, 2), camera.matrix, camera.distortion)
    return np.array((*np.asarray(straight, dtype=np.float64).ravel().tolist(), 1.0))
