"""The pose of a square marker from its four corners, and how well it is known."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from missionkit.geometry import Mat, Quat, Transform, exp, multiply, norm, to_matrix
from missionkit.messages import CameraModel

SIGMA_PX: Final = 0.3  # px, one coordinate of one corner
_LEAST_AREA: Final = 1.0  # px²
_NUDGE: Final = 1e-3 * np.array([[1.0, 0.0], [0.0, 2.0], [-3.0, 0.5], [0.0, -1.0]])  # px
_UPSIDE: Final = np.array([0.0, 1.0, 0.0, 0.0])  # right, up, out <-> right, down, in
_FLIP: Final = Transform(np.array([0.0, 0.0, 1.0, 0.0]), np.zeros(3))  # R_y(pi)


class Solution(NamedTuple):
    """One pose that explains the corners."""

    pose: Transform  # marker to camera
    error: float  # px, rms over the eight coordinates


def square(size: float) -> Mat:
    """Return the corners (4, 3), m, of a marker in its own axes, in OpenCV's order."""
    h = 0.5 * size
    return np.array([[-h, h, 0.0], [h, h, 0.0], [h, -h, 0.0], [-h, -h, 0.0]])


def project(points: Mat, pose: Transform, camera: CameraModel) -> Mat:
    """Return the image points (N, 2), px, of `points` (N, 3), m, in the frame `pose` maps from.

    Args:
        points: (N, 3), m, in the frame of the marker.
        pose: marker to camera, m.
        camera: whose distortion is applied.

    Returns:
        (N, 2), px; from behind the camera too, where it means nothing.
    """
    image, _ = cv2.projectPoints(
        points, to_matrix(pose.rotation), pose.translation, camera.matrix, camera.distortion
    )
    return np.asarray(image, dtype=np.float64).reshape(-1, 2)


def solve(
    corners: npt.NDArray[np.float64], size: float, camera: CameraModel
) -> tuple[Solution, ...]:
    """Return the poses that a square of edge `size` (m) may have, the best first.

        [R_m^c, t_m^c] = PnP(c, K, D, l)

    A small square has two: they differ in the tilt about an axis across the line of sight. Both
    come from IPPE and are then refined to least squares; when they meet there, one remains. It is
    empty if the corners are not finite, span no area, or put the marker behind the camera.

    The poses are found in axes (right, down, into the paper) that start at the corner nearest to
    the image's top left, so that no rotation comes near π: OpenCV's IPPE_SQUARE, whose axes are
    the marker's own, fails for rotations by π, which is how a marker looks that hangs straight.

    Source: P1 section 2.1, correction P1.3; Collins and Bartoli, "Infinitesimal plane-based pose
    estimation", 2014.

    Args:
        corners: (4, 2), px, clockwise from the marker's top left.
        size: m.
        camera: its lens.
    """
    if not _usable(corners):
        return ()
    points = square(size) * (1.0, -1.0, 1.0)
    first = int(np.argmin(corners.sum(axis=1)))
    turned = np.concatenate((corners[first:], corners[:first]))
    starts = _planar(points, turned, camera)
    refined = [_refined(points, turned, camera, start) for start in starts]
    own = multiply(exp(np.array([0.0, 0.0, -0.5 * math.pi * first])), _UPSIDE)
    ordered = sorted((s for s in refined if s is not None), key=lambda s: s.error)
    return _distinct([Solution(s.pose @ Transform(own, np.zeros(3)), s.error) for s in ordered])


def _usable(corners: npt.NDArray[np.float64]) -> bool:
    """Say whether the corners are finite and no three of them lie on a line."""
    if corners.shape != (4, 2) or not np.isfinite(corners).all():
        return False
    before, after = corners[[3, 0, 1, 2]] - corners, corners[[1, 2, 3, 0]] - corners
    triangles = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return bool((np.abs(triangles) > _LEAST_AREA).all())


def _planar(
    points: Mat, corners: npt.NDArray[np.float64], camera: CameraModel
) -> list[tuple[Mat, Mat]]:
    """Return IPPE's rotation vectors and translations.

    Of corners that are symmetric to the last bit, as only exact ones are, OpenCV's IPPE takes the
    root of a rounding error below zero. The nudge prevents that; the refinement undoes it.
    """
    found, turns, shifts, _ = cv2.solvePnPGeneric(
        points, corners + _NUDGE, camera.matrix, camera.distortion, flags=cv2.SOLVEPNP_IPPE
    )
    return [(np.array(turns[i], float), np.array(shifts[i], float)) for i in range(found)]


def _refined(
    points: Mat, corners: npt.NDArray[np.float64], camera: CameraModel, start: tuple[Mat, Mat]
) -> Solution | None:
    """Return the least-squares pose next to `start`; None if it is not in front of the camera."""
    turn, shift = cv2.solvePnPRefineLM(points, corners, camera.matrix, camera.distortion, *start)
    pose = Transform(exp(np.ravel(turn)), np.ravel(shift).astype(np.float64))
    # Also true for NaN: every corner must lie in front of the lens.
    if not pose.translation[2] > norm(points[0]):
        return None
    residual = project(points, pose, camera) - corners
    return Solution(pose, math.sqrt((residual * residual).sum() / residual.size))


def _distinct(ordered: list[Solution]) -> tuple[Solution, ...]:
    if (
        len(ordered) == 2
        and angle_between(ordered[0].pose.rotation, ordered[1].pose.rotation) < 1e-3
    ):
        return (ordered[0],)
    return tuple(ordered)


def angle_between(a: Quat, b: Quat) -> float:
    """Return the angle (rad) between two rotations."""
    return 2.0 * float(np.arccos(min(1.0, abs(float(a @ b)))))


def turned_to_camera(pose: Transform) -> Transform:
    """Return a marker-to-camera pose whose normal looks at the camera.

        φ = n_m · t_m;   if φ > 0:   R <- R · R_y(π)

    The last guard, after the choice between the two solutions. Source: P1 section 2.2.
    """
    normal = to_matrix(pose.rotation)[:, 2]
    return pose @ _FLIP if float(normal @ pose.translation) > 0.0 else pose
