"""Images in files, and what was found drawn into them."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import cv2
import numpy as np

from missionkit.geometry import Transform, to_matrix
from missionkit.messages import CameraModel, Detection, Image

AXIS = 0.5  # of a marker's edge


def read(path: str) -> Image | None:
    """Return the image in a file, None if there is none."""
    try:
        image = cv2.imread(path) if Path(path).is_file() else None
    except cv2.error:  # it claims to be too large
        return None
    return None if image is None else np.asarray(image, np.uint8)


def write(path: Path, image: Image) -> bool:
    """Write an image; False if that cannot be."""
    try:
        return bool(cv2.imwrite(str(path), image))
    except cv2.error:  # no such kind of picture
        return False


def outlined(image: Image, found: Iterable[Detection]) -> Image:
    """Return a BGR picture with the outlines and ids of markers drawn in."""
    picture = image.copy() if image.ndim == 3 else cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)
    for it in found:
        corners = np.asarray(it.corners, np.float32).reshape(1, 4, 2)
        cv2.aruco.drawDetectedMarkers(picture, [corners], np.array([[it.id]]))
    return np.asarray(picture, np.uint8)


def with_axes(picture: Image, pose: Transform, size: float, camera: CameraModel) -> Image:
    """Return the picture with the axes of a marker of edge `size` (m), its pose to the camera.

    Args:
        picture: (h, w, 3), BGR.
        pose: marker to camera.
        size: edge of the marker, m.
        camera: lens of the picture.
    """
    turn = cv2.Rodrigues(to_matrix(pose.rotation))[0]
    drawn = cv2.drawFrameAxes(
        picture, camera.matrix, camera.distortion, turn, pose.translation, AXIS * size
    )
    return np.asarray(drawn, np.uint8)
