"""What a camera that looks down shows of ground robots: boxes, two detectors, clutter, delays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from missionkit.estimation.target_tracking.apparent_size import size_with_tower
from missionkit.geometry import (
    Mat,
    Transform,
    Vec3,
    from_euler,
    multiply,
    normalised,
    to_matrix,
    vec,
)
from missionkit.ground_robot import GroundRobot
from missionkit.messages import BoxDetection, CameraModel, GroundDetection, GroundFrame
from missionkit.perception.camera_section import Camera, Mount
from missionkit.perception.ground_plane import ViewNoise, on_ground, view_of

ROBOT = GroundRobot()
FOCAL = 277.0  # px, 60 deg across 320 px
PERIOD = 0.05  # s
HEIGHT = 2.5  # m
DRIFT_TIME = 5.0  # s, correlation of what the vehicle is wrong about its pose


class Scene(NamedTuple):
    """How well robots are seen."""

    detectors: Sequence[str] = ("haar",)
    found: float = 1.0  # share of the robots in view that a detector finds
    false: float = 0.0  # boxes per frame and detector where no robot is
    pixel: float = 1.5  # px, sd of a box's centre, each axis
    position: float = 0.0  # m, sd of the vehicle's position, each axis, slow
    attitude: float = 0.0  # rad, sd of its attitude, each axis, slow
    size: float = 0.1  # sd of a box's size, relative


def camera() -> CameraModel:
    """Return the camera of the study, which looks down."""
    return Camera(
        width=320, height=240, focal=FOCAL, mount=Mount(position=(0.0, 0.0, 0.0), tilt_deg=90.0)
    ).model()


def above(north: float, east: float, height: float = HEIGHT) -> Transform:
    """Return the pose of a level vehicle that looks north.

    Args:
        north: m.
        east: m.
        height: m above the ground.
    """
    return Transform(from_euler(0.0, 0.0, 0.0), vec(north, east, -height))


class Watcher:
    """Turns true places into what the tracker is given.

    Args:
        scene: how well robots are seen.
        rng: where chance comes from.
    """

    def __init__(self, scene: Scene, rng: np.random.Generator) -> None:
        self._scene, self._rng, self._camera = scene, rng, camera()
        self._drift = rng.standard_normal(6)  # of the vehicle's pose: position, attitude

    def frame(self, at: float, body: Transform, places: Mat, towers: Mat) -> GroundFrame:
        """Return one frame.

        Args:
            at: s.
            body: the vehicle's true pose.
            places: (n, 2), m, of the robots.
            towers: (n,), m, their heights; 0: none.
        """
        detections = self.detections(body, places, towers)
        return GroundFrame(at, detections, view_of(self._camera, self._believed(body), 0.0))

    def detections(
        self, body: Transform, places: Mat, towers: Mat | None = None
    ) -> tuple[GroundDetection, ...]:
        """Return what one frame shows, one `PERIOD` after the last.

        Args:
            body: the vehicle's true pose.
            places: (n, 2), m, of the robots.
            towers: (n,), m, their heights; 0, or not given: none.
        """
        s = self._scene
        towers = np.zeros(len(places)) if towers is None else towers
        keep = math.exp(-PERIOD / DRIFT_TIME)
        kick = math.sqrt(1.0 - keep * keep) * self._rng.standard_normal(6)
        self._drift = keep * self._drift + kick
        believed = self._believed(body)
        noise = ViewNoise(s.pixel, s.position, s.position, s.attitude)
        found = (
            on_ground(box, self._camera, believed, 0.0, noise, ROBOT.diameter)
            for name in s.detectors
            for box in self._boxes(name, body, places, towers)
        )
        return tuple(it for it in found if it is not None)

    def as_believed(self, body: Transform, places: Mat) -> Mat:
        """Return where places (n, 2), m, seem to be, without noise of the detector, at this frame.

        What the vehicle is wrong about its own pose shifts and turns all that it sees, and what it
        flies to it finds there all the same.

        Args:
            body: the vehicle's true pose.
            places: (n, 2), m, in view.
        """
        believed, noise = self._believed(body), ViewNoise()
        boxes = (
            BoxDetection("", pixel, (1.0, 1.0), 1.0)
            for pixel in _pixels(places, body, self._camera)
        )
        seen = (on_ground(it, self._camera, believed, 0.0, noise, ROBOT.diameter) for it in boxes)
        return np.array([it.position for it in seen if it is not None])

    def _believed(self, body: Transform) -> Transform:
        """Return the pose that the vehicle believes it has."""
        s = self._scene
        turn = normalised(np.array((1.0, *(0.5 * s.attitude * self._drift[3:]))))
        shift = s.position * self._drift[:3]
        return Transform(multiply(turn, body.rotation), body.translation + shift)

    def _boxes(self, name: str, body: Transform, places: Mat, towers: Mat) -> list[BoxDetection]:
        s, rng = self._scene, self._rng
        pixels = _pixels(places, body, self._camera)
        height = -float(body.translation[2])
        boxes = []
        for pixel, place, tower in zip(pixels, places, towers, strict=True):
            if not (_in_image(pixel) and rng.random() < s.found):
                continue
            offset = math.dist(place, body.translation[:2])
            side = (
                size_with_tower(offset, height, tower, ROBOT.diameter)
                * FOCAL
                * ROBOT.diameter
                / height
            )
            side *= 1.0 + s.size * rng.standard_normal()
            centre = pixel + s.pixel * rng.standard_normal(2)
            boxes.append(BoxDetection(name, centre, (side, side), float(rng.uniform(0.6, 0.9))))
        for _ in range(rng.poisson(s.false)):
            side = float(FOCAL * ROBOT.diameter / height * rng.uniform(0.7, 1.4))
            centre = rng.uniform((0.0, 0.0), (319.0, 239.0))
            boxes.append(BoxDetection(name, centre, (side, side), float(rng.uniform(0.3, 0.7))))
        return boxes


def _pixels(places: Mat, body: Transform, lens: CameraModel) -> Mat:
    """Return where places (n, 2) on the ground are in the image, (n, 2), px."""
    eye = body @ lens.mount
    points = np.column_stack((places, np.zeros(len(places)))) - eye.translation
    seen = points @ to_matrix(eye.rotation)
    pixels = seen @ lens.matrix.T
    return np.asarray(pixels[:, :2] / pixels[:, 2:])


def _in_image(pixel: Vec3) -> bool:
    return bool(0.0 <= pixel[0] <= 319.0 and 0.0 <= pixel[1] <= 239.0)
