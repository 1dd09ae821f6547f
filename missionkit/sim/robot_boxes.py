"""Boxes that detectors of ground robots would find, for a simulated camera that does not render.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from missionkit.estimation.target_tracking.apparent_size import size_with_tower
from missionkit.geometry import Transform, Vec3, conjugate, rotate, vec
from missionkit.messages import BoxDetection, CameraModel
from missionkit.sim.marker_visibility import exposed, lens_of, project
from missionkit.sim.obstacle_distance import table
from missionkit.sim.robot_look import ROBOT, RobotLook
from missionkit.sim.world import World

PIXEL_SD: Final = 1.5  # px, of a box's centre, each axis
SIZE_SD: Final = 0.1  # of a box's side, relative
FOUND: Final = 0.96  # share of large robots in view that are found
SMALLEST: Final = 10.0  # px, side at which half of them are
FALSE: Final = 0.05  # boxes per frame where no robot is
SIMULATED: Final = "simulated"  # the detector's name
NEAREST: Final = 0.1  # m, from the camera, along its axis


class BoxSpotter:
    """Finds the robots of a world as detectors would: with noisy boxes, misses and false ones.

    A box's centre shows where its robot stands on the ground; a tower that leans out of the image
    makes it larger, as `apparent_size` expects.

    Args:
        world: with the robots, and what may hide them.
        camera: its lens and mount.
        rng: where chance comes from.
    """

    def __init__(self, world: World, camera: CameraModel, rng: np.random.Generator) -> None:
        self._things = table(world)
        self._camera = camera
        self._lens = lens_of(camera)
        self._rng = rng

    def find(
        self, body: Transform, robots: Sequence[RobotLook], mount: Transform | None = None
    ) -> tuple[BoxDetection, ...]:
        """Return the boxes of one frame.

        Args:
            body: body to world at the exposure.
            robots: in play.
            mount: camera to body, of a gimbal; None: the camera's own.
        """
        eye = body @ (mount or self._camera.mount)
        boxes = (self._box(eye, robot) for robot in robots)
        return (*(box for box in boxes if box is not None), *self._false(eye))

    def _box(self, eye: Transform, robot: RobotLook) -> BoxDetection | None:
        place = vec(robot.north, robot.east, 0.0)
        seen = rotate(conjugate(eye.rotation), place - eye.translation)
        if seen[2] < NEAREST or not exposed(self._things, eye.translation, place):
            return None
        side = self._side(float(seen[2])) * _reach(eye, robot)
        lost = 1.0 / (1.0 + math.exp(min(50.0, (side - SMALLEST) / 1.5)))
        found = self._rng.random() < FOUND * (1.0 - lost)
        noise, grown = self._rng.standard_normal(2), 1.0 + SIZE_SD * self._rng.standard_normal()
        centre = np.array(project(seen, self._lens)) + PIXEL_SD * noise
        if not (found and self._in_image(centre)):
            return None
        side *= max(0.5, float(grown))
        score = float(self._rng.uniform(0.6, 0.95))
        return BoxDetection(SIMULATED, centre, (side, side), score, "robot")

    def _side(self, depth: float) -> float:
        """Return how large (px) a robot is at a depth (m), P4 (7)."""
        return math.sqrt(self._lens.fx * self._lens.fy) * ROBOT.diameter / depth

    def _in_image(self, pixel: Vec3) -> bool:
        lens = self._lens
        return bool(0.0 <= pixel[0] <= lens.width - 1.0 and 0.0 <= pixel[1] <= lens.height - 1.0)

    def _false(self, eye: Transform) -> Iterator[BoxDetection]:
        """Yield boxes as large as robots that would stand a few metres ahead."""
        rng, lens = self._rng, self._lens
        usual = self._side(max(0.5, -float(eye.translation[2])))
        for _ in range(int(rng.poisson(FALSE))):
            centre = rng.uniform((0.0, 0.0), (lens.width - 1.0, lens.height - 1.0))
            side = usual * float(rng.uniform(0.7, 1.4))
            yield BoxDetection(
                SIMULATED, centre, (side, side), float(rng.uniform(0.3, 0.7)), "robot"
            )


def _reach(eye: Transform, robot: RobotLook) -> float:
    """Return how large a robot's box is, in its own diameters: its tower leans outwards."""
    north, east, down = eye.translation.tolist()
    offset = math.hypot(robot.north - north, robot.east - east)
    return size_with_tower(offset, -down, robot.tower, ROBOT.diameter)
