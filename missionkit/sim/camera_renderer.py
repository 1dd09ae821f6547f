"""Renders camera images: ground, sky, obstacles and markers, with lens distortion."""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np

from missionkit.geometry import Transform, Vec3, cross, rotate, to_matrix, vec
from missionkit.messages import CameraModel, Image
from missionkit.sim import ground_drawing, lens_model
from missionkit.sim.occlusion import OcclusionScene
from missionkit.sim.perspective_canvas import CanvasView, paint, view_of
from missionkit.sim.robot_drawing import robot_solids
from missionkit.sim.robot_look import RobotLook
from missionkit.sim.solid_shapes import Solid, deck_solids, edge_lines, moved, solids
from missionkit.sim.world import World
from missionkit.units import Spot

BLUR_DEPTH = 40.0  # m, depth assumed for motion blur where there is nothing nearer

cv2.setNumThreads(1)


class Renderer:
    """Renders one camera's frames of one world.

    Everything is painted back to front on an undistorted canvas, which the lens then bends. Two
    bodies are ordered by a plane that parts them. Motion blur is that of the nearest marker in
    view, or else of the middle of the image, for the image as a whole:
    with X = z (x, y, 1) a point in the camera's frame, Ẋ = -v - ω × X and
    u̇ = f (Ẋx - x Ẋz) / z.
    """

    def __init__(self, world: World, camera: CameraModel, rng: np.random.Generator) -> None:
        self._camera = camera
        self._lens = lens_model.lens(camera)
        self._sensor = lens_model.Sensor(camera.width, camera.height, rng)
        self._bands = ground_drawing.bands(
            world.ground.texture, math.ceil(math.hypot(*self._lens.size))
        )
        self._lines = () if world.arena is None else edge_lines(world.arena)
        self._scene = OcclusionScene(solids(world))
        self._deck = deck_solids(world)

    def render(
        self,
        body: Transform,
        velocity: Vec3,
        rates: Vec3,
        exposure: float,
        hidden: frozenset[int] = frozenset(),
        robots: Sequence[RobotLook] = (),
        shift: Spot = (0.0, 0.0),
        mount: Transform | None = None,
    ) -> Image:
        """Return one grey frame (height, width).

        Args:
            body: body FRD to world NED, in the middle of the exposure.
            velocity: (3,), m/s, NED, of the body's origin.
            rates: (3,), rad/s, FRD.
            exposure: how long the shutter is open, s.
            hidden: ids of markers that are not to be seen.
            robots: ground robots as they stand in the middle of the exposure.
            shift: m, north and east, by which the deck has driven.
            mount: camera to body, of a gimbal; None: the camera's own.
        """
        mount = mount or self._camera.mount
        view = view_of(body @ mount, self._lens)
        canvas = np.empty((view.size[1], view.size[0]), np.uint8)
        ground_drawing.paint(canvas, view, self._bands)
        for line in self._lines:
            paint(canvas, view, line)
        away = vec(*shift, 0.0)
        deck = [moved(it, away) for it in self._deck if it.marker not in hidden]
        moving = [*deck, *robot_solids(robots, view)]
        self._scene.shade(canvas, view, moving)
        visible = self._scene.arranged(view, hidden, moving)
        for solid in visible:
            for face in solid.faces(view.eye):
                paint(canvas, view, face)
        if self._lens.maps is not None:
            canvas = np.asarray(cv2.remap(canvas, *self._lens.maps, cv2.INTER_LINEAR), np.uint8)
        focus = self._focus(view, visible)
        flow = exposure * self._flow(view, (body, mount), velocity, rates, focus)
        return self._sensor.expose(lens_model.blur(canvas, float(flow[0]), float(flow[1])))

    def _focus(self, view: CanvasView, visible: list[Solid]) -> Vec3:
        """Return the point (3,), m, camera frame, whose motion blurs the image."""
        centres = [view.turn @ (s.centre - view.eye) for s in visible if s.marker is not None]
        ahead = [c for c in centres if c[2] > 0.1 and math.hypot(c[0], c[1]) < c[2]]
        if ahead:
            return min(ahead, key=lambda c: float(c[2]))
        sink, height = float(view.turn[2, 2]), -float(view.eye[2])
        ground_ahead = height > 0.0 and sink > height / BLUR_DEPTH
        depth = max(0.3, height / sink) if ground_ahead else BLUR_DEPTH
        return np.array([0.0, 0.0, depth])

    def _flow(
        self,
        view: CanvasView,
        placed: tuple[Transform, Transform],
        velocity: Vec3,
        rates: Vec3,
        focus: Vec3,
    ) -> Vec3:
        """Return the image velocity (2,), px/s, of a fixed point.

        Args:
            view: of the picture.
            placed: body to world, and camera to body.
            velocity: (3,), m/s, NED, of the body's origin.
            rates: (3,), rad/s, FRD.
            focus: (3,), m, camera frame, the point.
        """
        body, mount = placed
        moving = velocity + rotate(body.rotation, cross(rates, mount.translation))
        turning = to_matrix(mount.rotation).T @ rates
        drift = -(view.turn @ moving) - cross(turning, focus)
        focal = np.array([self._camera.matrix[0, 0], self._camera.matrix[1, 1]])
        return np.asarray(focal * (drift[:2] - focus[:2] / focus[2] * drift[2]) / focus[2])
