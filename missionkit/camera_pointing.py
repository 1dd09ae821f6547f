"""Where a camera looks: one that is fixed to the body, or one on a gimbal."""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import (
    Quat,
    Transform,
    Vec3,
    conjugate,
    from_euler,
    from_matrix,
    multiply,
    rotate,
    wrap,
    yaw_of,
)
from missionkit.messages import CameraModel, Estimate, GimbalAim, GimbalAngles

_FORWARD = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
STALE = 0.5  # s, after which a reading of the gimbal says nothing about now


def looking(tilt: float, pan: float = 0.0, roll: float = 0.0) -> Quat:
    """Return camera to body for a camera that looks forward, but for three turns (rad).

    Args:
        tilt: downwards.
        pan: to the right, before it is tilted.
        roll: clockwise about its axis, as seen from behind.
    """
    return multiply(from_euler(roll, -tilt, pan), from_matrix(_FORWARD))


def camera_to_body(
    camera: CameraModel, attitude: Quat, gimbal: GimbalAngles | None
) -> Transform | None:
    """Return camera to body FRD; None: it is on a gimbal, and how that is turned is not known.

    A gimbal turns the camera about its place on the body. It holds the pitch from the horizon and
    the yaw from the vehicle's heading, as GIMBAL_DEVICE_ATTITUDE_STATUS gives them.

    Args:
        camera: lens and mount.
        attitude: (4,), body to world.
        gimbal: how it is turned.
    """
    if camera.gimbal_sd is None:
        return camera.mount
    if gimbal is None:
        return None
    level = looking(-gimbal.pitch, yaw_of(attitude) + gimbal.yaw)
    return Transform(multiply(conjugate(attitude), level), camera.mount.translation)


def seen_mount(camera: CameraModel, seen: Estimate) -> Transform | None:
    """Return camera to body now; None: it is not known.

    Args:
        camera: lens and mount.
        seen: with the newest reading of the gimbal.
    """
    reading = seen.gimbal
    fresh = reading is not None and seen.now - reading.at <= STALE
    return camera_to_body(camera, seen.attitude, reading.angles if reading and fresh else None)


def angles_to(aim: GimbalAim, camera: CameraModel, seen: Estimate) -> GimbalAngles | None:
    """Return how the gimbal must be turned for an aim; None: that is not known.

    Args:
        aim: angles, a place or a target.
        camera: where the gimbal sits.
        seen: the estimate at this tick.
    """
    if aim.angles is not None:
        return aim.angles
    place = aim.place
    if aim.target is not None:
        target = seen.targets.get(aim.target)
        place = None if target is None else target.position
    if place is None or seen.health.diverged:
        return None
    return _angles(place - seen.position - rotate(seen.attitude, camera.mount.translation), seen)


def _angles(way: Vec3, seen: Estimate) -> GimbalAngles | None:
    """Return the angles of a direction (3,), m, NED; straight down or up the yaw is 0."""
    north, east, down = way.tolist()
    flat = math.hypot(north, east)
    if math.hypot(flat, down) < 1e-3:
        return None
    yaw = 0.0 if flat < 1e-3 else wrap(math.atan2(east, north) - seen.yaw)
    return GimbalAngles(math.atan2(-down, flat), yaw)
