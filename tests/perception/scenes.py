"""Markers at known places, as the camera would see them. Truth for the perception tests."""

from __future__ import annotations

import math

import cv2
import numpy as np

from missionkit.geometry import IDENTITY, Transform, from_euler, vec
from missionkit.goal_pose import facing
from missionkit.messages import CameraModel, Frame, Observation, Target
from missionkit.perception.camera_section import Camera
from missionkit.perception.marker_search import Priors
from missionkit.perception.opencv_helpers import marker_bitmap
from missionkit.perception.square_pose import project, square

DICTIONARY = "DICT_6X6_250"
CAMERA = Camera().model()
LEVEL = Transform(IDENTITY, np.zeros(3))  # the body at the origin, looking north


def marker_at(north, east, down, *, yaw=math.pi) -> Transform:
    """Return marker to world of an upright marker that faces heading `yaw`."""
    return Transform(facing(yaw), vec(north, east, down))


def seen_from(body: Transform, marker: Transform, camera: CameraModel = CAMERA) -> Transform:
    """Return marker to camera."""
    return (body @ camera.mount).inverse() @ marker


def tilted(distance: float, *, turn_deg=0.0, nod_deg=0.0) -> Transform:
    """Return marker to camera of a marker straight ahead, turned and nodded from head-on."""
    attitude = from_euler(math.radians(180.0 - nod_deg), math.radians(turn_deg), 0.0)
    return Transform(attitude, vec(0.0, 0.0, distance))


def corners_of(pose: Transform, size: float, camera: CameraModel = CAMERA):
    return project(square(size), pose, camera)


def noisy(corners, rng, sigma=0.3):
    return corners + rng.normal(0.0, sigma, corners.shape)


def render(markers, rng, *, noise=3.0, blur=0.6, camera: CameraModel = CAMERA):
    """Return a grey image of markers, each (id, corners (4, 2)), on a textured background."""
    shape = (camera.height, camera.width)
    coarse = cv2.resize(rng.normal(0, 1, (24, 32)), shape[::-1], interpolation=cv2.INTER_CUBIC)
    image = 120.0 + 25.0 * coarse
    for number, corners in markers:
        paper = np.full((250, 250), 200.0, np.float32)
        paper[25:-25, 25:-25] = 30.0 + 0.67 * marker_bitmap(DICTIONARY, number, 200)
        edges = np.array([[25, 25], [225, 25], [225, 225], [25, 225]], np.float32) - 0.5
        H = cv2.getPerspectiveTransform(edges, corners.astype(np.float32))
        # Four times as fine; the centre of fine pixel i lies at (i - 1.5) / 4.
        fine = np.array([[4.0, 0.0, 1.5], [0.0, 4.0, 1.5], [0.0, 0.0, 1.0]]) @ H
        size = (4 * shape[1], 4 * shape[0])
        layers = [cv2.warpPerspective(a, fine, size) for a in (paper, np.ones_like(paper))]
        colour, cover = (cv2.resize(a, shape[::-1], interpolation=cv2.INTER_AREA) for a in layers)
        image = image * (1.0 - cover) + colour
    image = cv2.GaussianBlur(image, (0, 0), blur) + rng.normal(0.0, noise, shape)
    return np.clip(image, 0, 255).astype(np.uint8)


def priors(*targets: Target, body: Transform | None = LEVEL, goal=None) -> Priors:
    return Priors(lambda _: body, {t.name: t for t in targets}, goal)


def target(name="trunk", position=(6.0, 0.0, 0.0), *, sd=1.0, yaw=math.pi, angle_sd=0.2) -> Target:
    attitude = None if yaw is None else facing(yaw)
    return Target(name, vec(*position), sd, attitude, angle_sd, None)


def with_corners(at: float, *found, now=None) -> Observation:
    """Return a tick in which a frame of ready corners, each (id, corners), arrived."""
    frame = Frame(at, None, tuple((DICTIONARY, number, c) for number, c in found))
    return Observation(at if now is None else now, frame=frame)


def with_image(at: float, image) -> Observation:
    return Observation(at, frame=Frame(at, image))
