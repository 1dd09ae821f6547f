"""Frames of a camera on a gimbal, looked at as if it sat on the body as the mission mounts it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Final, NamedTuple

from missionkit.camera_pointing import camera_to_body
from missionkit.geometry import Transform
from missionkit.messages import GIMBAL_UNKNOWN, CameraModel, Frame, Sighting
from missionkit.perception.marker_search import Priors
from missionkit.perception.vision_warning import VisionWarning

UNKNOWN: Final = (
    "how the gimbal is turned is not known, so frames of the camera are not used: does it send "
    "GIMBAL_DEVICE_ATTITUDE_STATUS?"
)


class GimbalView(NamedTuple):
    """What turns a frame of a gimbal into one of the fixed mount."""

    priors: Priors  # with the body at which a camera on the fixed mount would show the same
    turn: Transform  # camera as it was turned -> camera as mounted, of the real body
    angle_sd: float  # rad


def gimbal_view(camera: CameraModel, frame: Frame, priors: Priors) -> GimbalView | None:
    """Return how to look at a frame of a gimbal; None: where it looked is not known.

    With M the mount and M' camera to body at the exposure, a body at B M' M⁻¹ whose camera sits on
    M has the same picture; a pose in the picture becomes one of the fixed mount by M⁻¹ M'.

    Args:
        camera: lens and mount, on a gimbal.
        frame: as it came.
        priors: of the real body.
    """
    body = priors.body(frame.at)
    mounted = None if body is None else camera_to_body(camera, body.rotation, frame.gimbal)
    if body is None or mounted is None or camera.gimbal_sd is None:
        return None
    back = camera.mount.inverse()
    same_picture = body @ mounted @ back
    moved = priors._replace(body=lambda at: same_picture if at == frame.at else None)
    return GimbalView(moved, back @ mounted, camera.gimbal_sd)


def unknown(at: float) -> VisionWarning:
    """Return the warning of a frame at `at` (s) that cannot be used."""
    return VisionWarning(GIMBAL_UNKNOWN, (), UNKNOWN, at, at)


def on_fixed_mount(view: GimbalView, sightings: Iterable[Sighting]) -> tuple[Sighting, ...]:
    """Return sightings in the axes of a camera that sits on the fixed mount.

    Args:
        view: of their frame.
        sightings: in the axes of the camera as it was turned.
    """
    return tuple(
        it._replace(pose=view.turn @ it.pose, angle_sd=math.hypot(it.angle_sd, view.angle_sd))
        for it in sightings
    )
