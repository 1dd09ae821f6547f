"""Drawing ground robots: a round body with a bumper in front, a plate on top, perhaps a tower."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from typing import Final

import cv2
import numpy as np

from missionkit.estimation.target_tracking.apparent_size import TOWER_WIDTH
from missionkit.geometry import Vec3, vec
from missionkit.messages import Image
from missionkit.sim import textures
from missionkit.sim.perspective_canvas import CanvasView, Face, in_sight
from missionkit.sim.robot_look import ROBOT, RobotLook
from missionkit.sim.solid_shapes import Solid, circle, prism, ring_of

RADIUS: Final = 0.5 * ROBOT.diameter  # m
PLATE: Final = (0.22, 0.24)  # m, of the plate, along the heading and across
PAD: Final = 0.045  # m, radius of the touch pad, in the middle
BODY, BUMPER, POLE = 178, 58, 205  # grey levels of the paint
TEXELS: Final = 160  # across a robot seen from above
BODY_CORNERS, POLE_CORNERS = 24, 10


def robot_solids(robots: Sequence[RobotLook], view: CanvasView) -> list[Solid]:
    """Return the bodies and towers of the robots that may be in sight, back to front.

    Round bodies of one size that stand apart hide each other by their distance from the eye.

    Args:
        robots: as they stand at the exposure.
        view: of the camera.
    """
    if not robots:
        return []
    tops = np.array([max(ROBOT.height, it.tower) for it in robots])
    centres = np.column_stack(([it[:2] for it in robots], -0.5 * tops))
    near = in_sight(view, centres, np.hypot(RADIUS, 0.5 * tops))
    seen = [robots[n] for n in np.flatnonzero(near).tolist()]
    north, east = view.eye[:2].tolist()
    seen.sort(key=lambda it: math.hypot(it.north - north, it.east - east), reverse=True)
    return [part for robot in seen for part in parts(robot)]


def parts(robot: RobotLook) -> list[Solid]:
    """Return the body of a robot, and its tower if it has one."""
    at = vec(robot.north, robot.east, 0.0)
    body = _drum(at, RADIUS, 0.0, ROBOT.height, BUMPER, _top(robot))
    if robot.tower <= ROBOT.height:
        return [body]
    half = 0.5 * TOWER_WIDTH
    corner = at + vec(half, -half, -robot.tower)
    lid = Face(
        corner, vec(0.0, 2 * half, 0.0), vec(-2 * half, 0.0, 0.0), _lit(POLE), _NO_HULL, _WHITE
    )
    return [body, _drum(at, half, ROBOT.height, robot.tower, POLE, lid)]


_NO_HULL: Final = ring_of(np.zeros((1, 3)))  # a lid's hull is that of its drum
_WHITE: Final = 235


@functools.cache
def _lit(brightness: int) -> tuple[Image, ...]:
    return textures.pyramid(_from_above(np.full((8, 8), brightness, np.uint8)))


def _from_above(paint: Image) -> Image:
    return textures.grey(paint * textures.shade(np.array([0.0, 0.0, -1.0])))


@functools.cache
def top_texture(plate: int) -> tuple[Image, ...]:
    """Return the pyramid of a robot seen from above, heading upwards, (TEXELS, TEXELS), lit.

    Args:
        plate: grey level of the plate's paint.
    """
    scale = TEXELS / ROBOT.diameter
    middle = (0.5 * (TEXELS - 1),) * 2
    paint = np.full((TEXELS, TEXELS), BODY, np.uint8)

    def pixel(right: float, ahead: float) -> tuple[int, int]:
        return round(16 * (middle[0] + scale * right)), round(16 * (middle[1] - scale * ahead))

    def disc(radius: float, level: int) -> None:
        cv2.circle(paint, pixel(0, 0), round(16 * scale * radius), level, -1, cv2.LINE_AA, 4)

    front = round(scale * (RADIUS - 0.010))
    centre = (round(middle[0]), round(middle[1]))
    cv2.ellipse(paint, centre, (front, front), 0.0, 190, 350, BUMPER, round(scale * 0.022))
    long, wide = 0.5 * PLATE[0], 0.5 * PLATE[1]
    cv2.rectangle(paint, pixel(-wide, long), pixel(wide, -long), plate, -1, cv2.LINE_AA, 4)
    disc(PAD, 30)
    disc(0.6 * PAD, min(255, plate + 60))
    return textures.pyramid(_from_above(paint))


def _top(robot: RobotLook) -> Face:
    """Return the top of a body; its hull is that of its drum."""
    c, s = math.cos(robot.heading), math.sin(robot.heading)
    ahead, right = RADIUS * vec(c, s, 0.0), RADIUS * vec(-s, c, 0.0)
    corner = vec(robot.north, robot.east, -ROBOT.height) + ahead - right
    return Face(corner, 2 * right, -2 * ahead, top_texture(robot.plate), _NO_HULL, BODY, fine=True)


def _drum(at: Vec3, radius: float, bottom: float, top: float, brightness: int, lid: Face) -> Solid:
    """Return an upright drum: its side, painted over its silhouette, and its lid.

    Args:
        at: (3,), m, NED, of its axis on the ground.
        radius: m.
        bottom: m above the ground.
        top: m above the ground.
        brightness: grey level of its side's paint.
        lid: its hull is replaced.
    """
    corners = BODY_CORNERS if radius > TOWER_WIDTH else POLE_CORNERS
    hull = prism(circle(radius, corners) + at[:2], -top, -bottom)
    lid = lid._replace(hull=ring_of(hull.points[:corners]))

    def faces(eye: Vec3) -> list[Face]:
        dn, de = eye[:2] - at[:2]
        gap = math.hypot(dn, de)
        painted = [lid] if eye[2] < -top else []
        if gap > 1.001 * radius:
            c, s = dn / gap, de / gap
            half, ahead = radius * math.sqrt(1 - (radius / gap) ** 2), radius * radius / gap
            right = vec(s, -c, 0.0)
            left = at + vec(ahead * c, ahead * s, -top) - half * right
            side = textures.drum(brightness)[textures.sector(math.atan2(de, dn))]
            middle = int(side[0][0, side[0].shape[1] // 2])
            below = vec(0.0, 0.0, top - bottom)
            painted.insert(0, Face(left, 2 * half * right, below, side, hull, middle))
        return painted

    return Solid(hull, np.array([[0.0, 0.0, 1.0]]), faces)
