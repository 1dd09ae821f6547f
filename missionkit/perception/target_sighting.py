"""From a detected marker to a sighting of its target."""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import IDENTITY, Transform, norm
from missionkit.messages import CameraModel, Detection, Sighting, Target
from missionkit.perception.aruco import Aruco
from missionkit.perception.marker_selection import Candidate
from missionkit.perception.pose_ambiguity import Expectation, resolve
from missionkit.perception.pose_covariance import pose_deviations
from missionkit.perception.square_pose import (
    SIGMA_PX,
    Solution,
    solve,
    turned_to_camera,
)


def sight(
    detection: Detection,
    marker: Aruco,
    camera: CameraModel,
    *,
    at: float,
    body: Transform | None,
    prior: Target | None,
) -> Candidate | None:
    """Return what one detected marker says about its target, or None if it has no pose.

    `body` (body to world at `at`) and `prior` help to choose between the two planar solutions;
    the pose is moved from the marker's centre to the target's.

    Args:
        detection: corners of the marker in the image.
        marker: its size, and where it is on the target.
        camera: lens and mount.
        at: s, mid-exposure.
        body: body to world, if known.
        prior: earlier estimate of the target, if any.
    """
    solutions = solve(detection.corners, marker.size, camera)
    if not solutions:
        return None
    eye = None if body is None else body @ camera.mount
    best, ambiguous = resolve(solutions, _expectation(eye, marker, prior))
    sure = Solution(turned_to_camera(best.pose), best.error)
    noise = max(SIGMA_PX, best.error)
    known = pose_deviations(sure, marker.size, camera, noise, alone=len(solutions) == 1)
    if known is None:
        return None
    along, angle = known
    offset = np.array(marker.offset)
    centre = sure.pose @ Transform(IDENTITY, -offset)
    sighting = Sighting(
        at=at,
        target=marker.target,
        id=marker.id,
        pose=centre,
        position_sd=math.hypot(along, norm(offset) * angle),
        angle_sd=angle,
        error=best.error,
        ambiguous=ambiguous,
        detection=detection,
    )
    return Candidate(sighting, None if eye is None else eye.apply(centre.translation))


def _expectation(eye: Transform | None, marker: Aruco, prior: Target | None) -> Expectation:
    return Expectation(
        camera=None if eye is None else eye.rotation,
        upright=marker.upright,
        attitude=None if prior is None else prior.attitude,
        angle_sd=None if prior is None else prior.angle_sd,
    )
