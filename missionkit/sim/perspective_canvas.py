"""Drawing textured planes in perspective, clipped at the near plane and at the canvas."""

from __future__ import annotations

import math
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from missionkit.geometry import Mat, Transform, Vec3, to_matrix
from missionkit.messages import Image
from missionkit.sim.lens_model import Lens
from missionkit.sim.texture_patches import (
    Polygon,
    area_of,
    clip,
    patches_of,
    warp,
)

NEAR_PLANE = 0.05  # m, nothing closer to the camera is drawn
SPLIT = 16_000  # px², smaller patches are not split


class CanvasView(NamedTuple):
    """Where the canvas stands: pixel ~ projection (point - eye)."""

    eye: Vec3  # (3,), m, NED
    turn: Mat  # (3, 3), world to camera
    projection: Mat  # (3, 3), px, canvas matrix times turn
    size: tuple[int, int]  # width, height, px
    rays: Mat  # (3, 3), canvas to ray, NED: inverse of the projection
    sides: Mat  # (5, 3), inward normals of the pyramid of sight, NED, the last one ahead


class Hull(NamedTuple):
    """A convex body by its corners and edges."""

    points: npt.NDArray[np.float64]  # (V, 3), m, NED
    edges: npt.NDArray[np.intp]  # (E, 2)


class Face(NamedTuple):
    """A textured plane and the body over whose silhouette it is painted.

    The texture's top left corner lies at `origin`, its top right at `origin + across`, its
    bottom left at `origin + down`; beyond the texture is the grey level `border`.
    """

    origin: Vec3  # (3,), m, NED
    across: Vec3  # (3,), m
    down: Vec3  # (3,), m
    texture: tuple[Image, ...]  # pyramid
    hull: Hull
    border: int
    fine: bool = False  # antialiased by supersampling


def view_of(camera: Transform, lens: Lens) -> CanvasView:
    """Return the view through `lens` of a camera at `camera` (camera to world)."""
    turn = to_matrix(camera.rotation).T
    projection = lens.matrix @ turn
    rays = np.asarray(np.linalg.inv(projection), np.float64)
    sides = _sides(rays, turn[2], lens.size)
    return CanvasView(camera.translation, turn, projection, lens.size, rays, sides)


def _sides(rays: Mat, ahead: Vec3, size: tuple[int, int]) -> Mat:
    """Return the inward normals (5, 3) of the sides of the pyramid of sight, and `ahead`."""
    width, height = size
    corners = np.array([[0, width, width, 0], [0, 0, height, height], [1, 1, 1, 1]])
    edges = (rays @ corners).T
    x, y, z = edges.T
    nx, ny, nz = edges[[1, 2, 3, 0]].T
    sides = np.stack([ny * z - nz * y, nz * x - nx * z, nx * y - ny * x], axis=1)
    sides /= np.copysign(np.linalg.norm(sides, axis=1), sides @ ahead)[:, None]
    return np.vstack([sides, ahead])


def in_sight(view: CanvasView, centres: Mat, radii: Mat) -> npt.NDArray[np.bool_]:
    """Say which spheres (N, 3), (N,), m, NED, reach into the pyramid of sight.

    Args:
        view: of the camera.
        centres: (N, 3), m, NED.
        radii: (N,), m.

    Returns:
        (N,).
    """
    gaps = (centres - view.eye) @ view.sides.T
    return np.asarray((gaps > -radii[:, None]).all(axis=1))


def outline(view: CanvasView, hull: Hull) -> Polygon:
    """Return the silhouette of a convex body on the canvas; empty when out of sight."""
    image = (hull.points - view.eye) @ view.projection.T
    depth = image[:, 2]
    front = depth > NEAR_PLANE
    if not front.any():
        return []
    if not front.all():
        image = np.vstack([image[front], _cut(image, front, hull.edges)])
    pixels = image[:, :2] / image[:, 2:]
    low, high = pixels.min(axis=0), pixels.max(axis=0)
    width, height = view.size
    if high[0] < 0 or high[1] < 0 or low[0] > width - 1 or low[1] > height - 1:
        return []
    polygon = [tuple(p) for p in cv2.convexHull(pixels.astype(np.float32))[:, 0].tolist()]
    if low[0] < -1 or low[1] < -1 or high[0] > width or high[1] > height:
        polygon = crop(polygon, view.size)
    return polygon


def _cut(image: Mat, front: npt.NDArray[np.bool_], edges: npt.NDArray[np.intp]) -> Mat:
    """Return where edges pass the near plane."""
    crossing = edges[front[edges[:, 0]] != front[edges[:, 1]]]
    a, b = image[crossing[:, 0]], image[crossing[:, 1]]
    t = (NEAR_PLANE - a[:, 2]) / (b[:, 2] - a[:, 2])
    return np.asarray(a + t[:, None] * (b - a))


def crop(polygon: Polygon, size: tuple[int, int]) -> Polygon:
    """Return the part of a convex polygon on a canvas, with a rim of one pixel."""
    width, height = size
    for line in ((1, 0, 1), (-1, 0, width), (0, 1, 1), (0, -1, height)):
        polygon = clip(polygon, line)
    return polygon


def paint(canvas: Image, view: CanvasView, face: Face) -> None:
    """Draw `face` on the canvas, in place.

    Args:
        canvas: (h, w), grey, changed in place.
        view: pose and lens of the camera.
        face: texture, and where it is.
    """
    polygon = outline(view, face.hull)
    if len(polygon) < 3:
        return
    frame = np.empty((3, 3))
    frame[:, 0], frame[:, 1], frame[:, 2] = face.across, face.down, face.origin - view.eye
    forward = view.projection @ frame
    if abs(np.linalg.det(forward)) < 1e-9:
        return
    back = np.asarray(np.linalg.inv(forward), np.float64)
    factor = _supersampling(area_of(polygon)) if face.fine else 1
    texture = _level(face, back, polygon, factor)
    for patch in patches_of(canvas, polygon):
        drawn = warp(texture, back, patch, face.border, factor)
        patch.lay(drawn)


def _supersampling(area: float) -> int:
    if area < 10_000:
        return 4
    return 2 if area < 80_000 else 1


def _level(face: Face, back: Mat, polygon: Polygon, factor: int) -> Image:
    """Return the level whose texels are about as large as a (sub)pixel amid the polygon."""
    x = sum(p[0] for p in polygon) / len(polygon)
    y = sum(p[1] for p in polygon) / len(polygon)
    (a, b, c), (d, e, f), (g, h, i) = back.tolist()
    w = g * x + h * y + i
    u, v = (a * x + b * y + c) / w, (d * x + e * y + f) / w
    rows, columns = face.texture[0].shape
    ux, uy = columns * (a - u * g) / w, columns * (b - u * h) / w
    vx, vy = rows * (d - v * g) / w, rows * (e - v * h) / w
    if face.fine:
        density = math.hypot(ux, uy, vx, vy) / math.sqrt(2.0) / factor
    else:
        density = math.sqrt(abs(ux * vy - uy * vx))
    level = round(math.log2(max(1.0, density)))
    return face.texture[min(level, len(face.texture) - 1)]
