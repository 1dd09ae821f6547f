"""Whether a camera sees a marker from where a behaviour stands off it."""

from __future__ import annotations

import math

import numpy as np

from missionkit import polygons
from missionkit.geometry import Mat, Vec3, conjugate, from_euler, rotate
from missionkit.messages import CameraModel
from missionkit.perception.aruco import Aruco
from missionkit.units import Point

CORNERS = ((-0.5, 0.5), (0.5, 0.5), (0.5, -0.5), (-0.5, -0.5))  # of a marker: right, up
HEADINGS = 16  # that are tried


def unseen(camera: CameraModel, marker: Aruco, standoff: Point, turn_deg: float = 0.0) -> str:
    """Return why a camera does not see a marker, "" if it does; its lens does not distort.

    Args:
        camera: on a body that is level and faces the marker, but for a turn.
        marker: hangs upright.
        standoff: (3,), m, out, right and up of the vehicle from the target.
        turn_deg: deg, of the body from facing the marker, clockwise as seen from above.
    """
    out, right, up = standoff
    across, above, ahead = marker.offset
    unturned = from_euler(0.0, 0.0, -math.radians(turn_deg))
    corners = [
        (
            out - ahead,
            across + x * marker.size - right,
            up - above - y * marker.size,
        )
        for x, y in CORNERS
    ]
    body = [rotate(unturned, np.array(it)) for it in corners]
    pixels = _pixels(camera, body)
    if pixels is None:
        return "the marker lies beside or behind the camera"
    if not _in_picture(camera, pixels):
        column, row = pixels.mean(axis=0)
        return (
            f"the marker is not wholly in the picture: its centre lies at pixel {column:.0f}, "
            f"{row:.0f} of {camera.width} x {camera.height}, and it is {_extent(pixels)} px wide"
        )
    area = _area(pixels)
    if not marker.min_area <= area <= marker.max_area:
        limit = "min_area" if area < marker.min_area else "max_area"
        bound = getattr(marker, limit)
        return f"the marker covers {area:.0f} px², beyond its {limit!r} of {bound:g} px²"
    return ""


def seen_below(camera: CameraModel, marker: Aruco, height: float) -> bool:
    """Say whether a camera sees a marker that lies face up, from above its target's middle.

    It does if the whole marker is in the picture for some heading, and as large as its detector
    wants it; the lens does not distort.

    Args:
        camera: on a body that is level.
        marker: lies on the ground.
        height: m, of the vehicle above the target.
    """
    return any(
        _whole(camera, marker, height, 2.0 * math.pi * n / HEADINGS) for n in range(HEADINGS)
    )


def _whole(camera: CameraModel, marker: Aruco, height: float, heading: float) -> bool:
    across, along, above = marker.offset
    c, s = math.cos(heading), math.sin(heading)
    body = [
        np.array((c * y + s * x, c * x - s * y, height - above))
        for x, y in ((across + i * marker.size, along + j * marker.size) for i, j in CORNERS)
    ]
    pixels = _pixels(camera, body)
    if pixels is None or not _in_picture(camera, pixels):
        return False
    return marker.min_area <= _area(pixels)


def _pixels(camera: CameraModel, corners: list[Vec3]) -> Mat | None:
    """Return where a lens without distortion shows points (3,), m, FRD; None: not before it."""
    back = conjugate(camera.mount.rotation)
    seen = [rotate(back, it - camera.mount.translation) for it in corners]
    if any(float(it[2]) <= 0.0 for it in seen):
        return None
    return np.array([(camera.matrix @ it / it[2])[:2] for it in seen])


def _in_picture(camera: CameraModel, pixels: Mat) -> bool:
    size = np.array([camera.width - 1, camera.height - 1])
    return not ((pixels < 0.0).any() or (pixels > size).any())


def _area(pixels: Mat) -> float:
    """Return the area (px²) of a marker."""
    return abs(polygons.area([(x, y) for x, y in pixels.tolist()]))


def _extent(pixels: Mat) -> int:
    return math.ceil(float(np.ptp(pixels[:, 0])))
