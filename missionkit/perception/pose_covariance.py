"""How well the pose of a square marker is known from its corners."""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Mat, Transform, Vec3, cross, exp, multiply, norm, skew, to_matrix
from missionkit.messages import CameraModel
from missionkit.perception.square_pose import Solution, square


def covariance(pose: Transform, size: float, camera: CameraModel, sigma: float) -> Mat | None:
    """Return the covariance (6, 6) of a pose: rotation (rad), then translation (m).

        P = σ² (Jᵀ J)⁻¹,   J = ∂π/∂p · [-[R x]×, I],   π(X, Y, Z) = (f_x X/Z, f_y Y/Z)

    for independent corner noise `sigma` (px). Both parts are in camera axes, the rotation error
    on the left: R = Exp(δθ) R̂. The lens's distortion changes J by a few percent and is left out.
    None if the corners do not determine the pose.

    Source: Hartley and Zisserman, "Multiple View Geometry", 2nd edition, section 5.2.

    Args:
        pose: marker to camera.
        size: edge of the marker, m.
        camera: its lens.
        sigma: corner noise, px.
    """
    arms = square(size) @ to_matrix(pose.rotation).T  # (4, 3), m, from the marker's centre
    J = np.concatenate([_rows(arm, arm + pose.translation, camera.matrix) for arm in arms])
    information = J.T @ J
    least, *_, most = np.linalg.eigvalsh(information).tolist()
    if not most < 1e12 * least:
        return None
    return np.asarray(sigma * sigma * np.linalg.inv(information))


def _rows(arm: Vec3, point: Vec3, K: Mat) -> Mat:
    """Return the two rows (2, 6) of J that belong to one corner."""
    (x, y, z), fx, fy = point.tolist(), float(K[0, 0]), float(K[1, 1])
    slope = np.array([[fx / z, 0.0, -fx * x / z**2], [0.0, fy / z, -fy * y / z**2]])
    return np.concatenate((-slope @ skew(arm), slope), axis=1)


def deviations(P: Mat, pose: Transform) -> tuple[float, float]:
    """Return the standard deviation along the line of sight (m) and of the worst rotation (rad)."""
    sight = pose.translation / norm(pose.translation)
    along = float(sight @ P[3:, 3:] @ sight)
    worst = float(np.linalg.eigvalsh(P[:3, :3])[-1])
    return along**0.5, worst**0.5


def pose_deviations(
    solution: Solution, size: float, camera: CameraModel, sigma: float, *, alone: bool
) -> tuple[float, float] | None:
    """Return the standard deviations (m along the line of sight, rad) of a solution.

    Where a solution stands `alone`, its mirror image has merged with it near the head-on view and
    the error is no longer linear: the tilt found may be noise. The rotation is then not claimed to
    be better than its own distance from head-on, or than it would be known head-on, whichever is
    less. None if the corners do not determine the pose.

    Args:
        solution: of the pose.
        size: edge of the marker, m.
        camera: its lens.
        sigma: corner noise, px.
        alone: the mirrored solution has merged with it.
    """
    P = covariance(solution.pose, size, camera, sigma)
    if P is None:
        return None
    along, angle = deviations(P, solution.pose)
    if alone:
        straight, tilt = head_on(solution.pose)
        Q = covariance(straight, size, camera, sigma)
        angle = max(angle, tilt if Q is None else min(tilt, deviations(Q, straight)[1]))
    return along, angle


def head_on(pose: Transform) -> tuple[Transform, float]:
    """Return `pose` turned the shortest way to face the camera, and by how much (rad)."""
    normal = to_matrix(pose.rotation)[:, 2]
    sight = -pose.translation / norm(pose.translation)
    axis = cross(normal, sight)
    length = norm(axis)
    angle = math.atan2(length, float(normal @ sight))
    turn = exp(axis * (angle / max(length, 1e-12)))
    return Transform(multiply(turn, pose.rotation), pose.translation), angle
