"""Camera of a free flyer: feature points of the target's faces, measured in its own frame."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.docking_geometry import NORMALS, face_rotation, turned
from missionkit.geometry import Mat, Vec3, rotate, to_matrix, vec
from missionkit.messages import Features
from missionkit.sim.free_flyer.world import DockingTarget, FreeFlyerWorld
from missionkit.sim.random_blocks import Normals
from missionkit.sim.sensors import Beat


class FeatureTable(NamedTuple):
    """The feature points of a target, in the target's frame."""

    names: tuple[str, ...]  # face and number, such as top1
    points: Mat  # (N, 3), m
    normals: Mat  # (N, 3), of the faces that carry them


def features_of(target: DockingTarget) -> FeatureTable:
    """Return the feature points of all lit faces, in the target's frame.

    Those of a face lie along x and y of a chaser that is docked there without roll.
    """
    names, points, normals = [], [], []
    for face in target.lit:
        turn, outward = face_rotation(face), NORMALS[face]
        for n, (along_x, along_y) in enumerate(target.features, 1):
            names.append(f"{face}{n}")
            flat = rotate(turn, vec(along_x, along_y, 0.0))
            points.append(flat + 0.5 * target.size * vec(*outward))
            normals.append(outward)
    return FeatureTable(
        tuple(names), np.array(points).reshape(-1, 3), np.array(normals).reshape(-1, 3)
    )


class FeatureCamera:
    """Measures, at its rate while it is switched on, what P3 (section III) says is in view."""

    def __init__(self, world: FreeFlyerWorld, rng: np.random.Generator) -> None:
        model, pose = world.sensors.camera, world.target.pose
        table, turn = features_of(world.target), to_matrix(world.target.pose.rotation)
        self.beat = Beat(model.rate)
        self._name = world.target.name
        self._names = table.names
        self._points = table.points @ turn.T + pose.translation
        self._normals = table.normals @ turn.T
        self._target = pose.translation
        self._place, self._mount = np.array(model.position), to_matrix(turned(model.attitude_deg))
        self._range, self._cone = model.range, math.cos(math.radians(model.half_angle_deg))
        self._sd = model.sd
        self._noise = Normals(rng, 3 * max(1, len(self._names)), 100)
        self._last: Features | None = None

    def measure(self, at: float, x: Vec3, *, on: bool, frozen: bool) -> Features | None:
        """Return the features in view at `at` (s), None if there are none.

        Args:
            at: time of the exposure.
            x: (13,) true state.
            on: it is switched on.
            frozen: it repeats what it saw last, with its old time.
        """
        noise = self._noise.take(1)[0].reshape(-1, 3)
        if not on:
            return None
        if frozen:
            return self._last
        seen = self._seen(at, x, noise)
        self._last = seen or self._last
        return seen

    def _seen(self, at: float, x: Vec3, noise: Mat) -> Features | None:
        axes = to_matrix(x[6:10])
        place, axes = x[:3] + axes @ self._place, axes @ self._mount
        sight = self._target - place
        away = math.sqrt(float(sight @ sight))
        if away > self._range or float(sight @ axes[:, 2]) < self._cone * away:
            return None
        turned_here = ((place - self._points) * self._normals).sum(axis=1) > 0.0
        shown = np.flatnonzero(turned_here)
        if not len(shown):
            return None
        points = (self._points[shown] - place) @ axes + self._sd * noise[shown]
        return Features(at, self._name, tuple(self._names[n] for n in shown), points)
