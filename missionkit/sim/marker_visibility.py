"""Detections of a simulated camera that does not render: the corners of markers.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from missionkit.geometry import Mat, Transform, Vec3, conjugate, multiply, rotate, vec
from missionkit.jit import compiled
from missionkit.messages import CameraModel
from missionkit.sim.obstacle_distance import cast
from missionkit.sim.world import Marker
from missionkit.units import Spot

Corners = tuple[str, int, npt.NDArray[np.float64]]
PIXEL_SD = 0.25  # px
FACE_TOLERANCE = 0.05  # m, an obstacle closer than this behind the marker's face does not hide it
turn = compiled(rotate)
inverse = compiled(conjugate)
chain = compiled(multiply)


class PinholeLens(NamedTuple):
    """Constants of the projection (px), with OpenCV's distortion."""

    fx: float
    fy: float
    cx: float
    cy: float
    k1: float
    k2: float
    p1: float
    p2: float
    k3: float
    width: float
    height: float


def lens_of(camera: CameraModel) -> PinholeLens:
    """Return the constants of `camera`."""
    K = camera.matrix
    values = (K[0, 0], K[1, 1], K[0, 2], K[1, 2], *camera.distortion, camera.width, camera.height)
    return PinholeLens(*(float(value) for value in values))


def outline(marker: Marker) -> Mat:
    """Return centre, then corners from the top left clockwise: (5, 3), m, NED."""
    h = 0.5 * marker.size
    flat = [(0.0, 0.0), (-h, h), (h, h), (h, -h), (-h, -h)]
    return np.array([marker.pose.apply(vec(x, y, 0.0)) for x, y in flat])


@compiled
def project(point: Vec3, lens: PinholeLens) -> tuple[float, float]:
    """Return the pixel of a point (3,), m, in camera axes, in front of the camera.

    Source: OpenCV, "Camera Calibration and 3D Reconstruction", k1 k2 p1 p2 k3.
    """
    x, y = point[0] / point[2], point[1] / point[2]
    r = x * x + y * y
    radial = 1.0 + r * (lens.k1 + r * (lens.k2 + r * lens.k3))
    u = x * radial + 2.0 * lens.p1 * x * y + lens.p2 * (r + 2.0 * x * x)
    v = y * radial + lens.p1 * (r + 2.0 * y * y) + 2.0 * lens.p2 * x * y
    return lens.fx * u + lens.cx, lens.fy * v + lens.cy


@compiled
def exposed(things: Mat, eye: Vec3, point: Vec3) -> bool:
    """Tell whether nothing stands between `eye` and `point` (3,), m, NED.

    Args:
        things: (n, ·) obstacles, a row each.
        eye: (3,), m, NED.
        point: (3,), m, NED, not at `eye`.
    """
    way = point - eye
    far = math.sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2])
    return bool(cast(things, eye, way / far) > far - FACE_TOLERANCE)


@compiled
def facing(shape: Mat, eye: Vec3) -> float:
    """Return the cosine of the angle between a marker's normal and the line to `eye`."""
    across, down = shape[2] - shape[1], shape[4] - shape[1]
    n = down[1] * across[2] - down[2] * across[1]
    e = down[2] * across[0] - down[0] * across[2]
    d = down[0] * across[1] - down[1] * across[0]
    look = eye - shape[0]
    along = n * look[0] + e * look[1] + d * look[2]
    far = look[0] * look[0] + look[1] * look[1] + look[2] * look[2]
    return float(along / math.sqrt((n * n + e * e + d * d) * far))


@compiled
def outlined(
    shape: Mat, eye: Vec3, back: Vec3, lens: PinholeLens, things: Mat, pixels: Mat
) -> bool:
    """Project the corners into `pixels` (4, 2); return whether the whole marker is in view.

    Args:
        shape: (5, 3), m, NED, centre and corners.
        eye: (3,), m, NED, of the camera.
        back: world to camera.
        lens: of the camera.
        things: (n, ·) obstacles that may hide it.
        pixels: (4, 2), px, written.
    """
    for n in range(5):
        local = turn(back, shape[n] - eye)
        if local[2] < 0.05 or not exposed(things, eye, shape[n]):
            return False
        if n > 0:
            u, v = project(local, lens)
            pixels[n - 1, 0], pixels[n - 1, 1] = u, v
            if not (1.0 < u < lens.width - 2.0 and 1.0 < v < lens.height - 2.0):
                return False
    return True


@compiled
def image_speed(point: Vec3, velocity: Vec3, rates: Vec3) -> float:
    """Return how fast a fixed point moves over the image, in focal lengths per second.

    Ẋ = -v - ω × X, and the image velocity is (Ẋ_xy - X_xy Ẋ_z / X_z) / X_z.

    Args:
        point: (3,) X, m, camera axes.
        velocity: (3,) v, m/s, of the camera, camera axes.
        rates: (3,) ω, rad/s, of the camera, camera axes.
    """
    x, y, z = point[0], point[1], point[2]
    dx = -velocity[0] - (rates[1] * z - rates[2] * y)
    dy = -velocity[1] - (rates[2] * x - rates[0] * z)
    dz = -velocity[2] - (rates[0] * y - rates[1] * x)
    u, v = (dx - x / z * dz) / z, (dy - y / z * dz) / z
    return math.sqrt(u * u + v * v)


@compiled
def glimpse(
    shapes: Mat, x: Vec3, place: Vec3, mount: Vec3, lens: PinholeLens, things: Mat, pixels: Mat
) -> Mat:
    """Look at every marker; return (M, 2): cosine of its obliquity (0: not in view), image speed.

    Args:
        shapes: (M, 5, 3) m, NED, outlines.
        x: (13,) true state of the body.
        place: (3,) m, FRD, of the camera.
        mount: (4,) camera to body.
        lens: constants.
        things: (N, 8) obstacles.
        pixels: (M, 4, 2) px, result.
    """
    views = np.zeros((shapes.shape[0], 2))
    q = x[6:10]
    eye = x[:3] + turn(q, place)
    back = inverse(chain(q, mount))
    rates = turn(inverse(mount), x[10:13])
    velocity = turn(back, x[3:6])
    for n in range(shapes.shape[0]):
        cosine = facing(shapes[n], eye)
        if cosine > 0.05 and outlined(shapes[n], eye, back, lens, things, pixels[n]):
            views[n, 0] = cosine
            views[n, 1] = image_speed(turn(back, shapes[n, 0] - eye), velocity, rates)
    return views


def chance(side: float, cosine: float, smear: float) -> float:
    """Return the probability that a detector finds a marker.

    A product of logistic curves fitted by eye to `DICT_6X6_250` in OpenCV: half are lost at a side
    of 14 px, at 78 degrees of obliquity, and at a motion blur of 0.15 sides.

    Args:
        side: px, of the square of equal area.
        cosine: of the angle between the marker's normal and the line of sight.
        smear: px, image motion during the exposure.
    """
    return (
        0.99
        * _logistic((side - 14.0) / 1.5)
        * _logistic((cosine - 0.2) / 0.03)
        * _logistic((0.15 * side - smear) / (0.02 * side + 0.1))
    )


def _logistic(x: float) -> float:
    return 1.0 / (1.0 + math.exp(-max(-50.0, min(50.0, x))))


def area_of(pixels: Mat) -> float:
    """Return the area (px²) of a quadrilateral (4, 2).  Source: shoelace formula."""
    a, b = pixels[2] - pixels[0], pixels[3] - pixels[1]
    return 0.5 * abs(float(a[0] * b[1] - a[1] * b[0]))


class Spotter:
    """Finds the markers of a world as a detector would: with noisy corners, and not always.

    Args:
        markers: of the world.
        camera: its lens and mount.
        things: (N, 8) obstacles.
        rng: the camera's stream.
        carried: how many of the markers, the last ones, lie on the deck.
    """

    def __init__(
        self,
        markers: Sequence[Marker],
        camera: CameraModel,
        things: Mat,
        rng: np.random.Generator,
        carried: int = 0,
    ) -> None:
        self._first = len(markers) - carried
        self._markers = tuple(markers)
        self._shapes = np.array([outline(m) for m in markers]).reshape(-1, 5, 3)
        self._lens = lens_of(camera)
        self._mount = camera.mount
        self._things = things
        self._rng = rng

    def find(
        self,
        x: Vec3,
        exposure: float,
        hidden: frozenset[int],
        shift: Spot = (0.0, 0.0),
        mount: Transform | None = None,
    ) -> tuple[Corners, ...]:
        """Return dictionary, id and corners (4, 2), px, of each marker found.

        Args:
            x: (13,) true state at the middle of the exposure, see `kernel_layout`.
            exposure: s.
            hidden: ids of markers that are covered.
            shift: m, north and east, by which the deck has driven.
            mount: camera to body, of a gimbal; None: the camera's own.
        """
        shapes = self._shapes
        if shift != (0.0, 0.0):
            shapes = shapes.copy()
            shapes[self._first :, :, :2] += shift
        pixels = np.empty((len(self._markers), 4, 2))
        mount = mount or self._mount
        place, turned = mount.translation, mount.rotation
        views = glimpse(shapes, x, place, turned, self._lens, self._things, pixels)
        found: list[Corners] = []
        for marker, (cosine, speed), corners in zip(
            self._markers, views.tolist(), pixels, strict=True
        ):
            if cosine <= 0.0 or marker.id in hidden:
                continue
            smear = self._lens.fx * exposure * speed
            if self._rng.random() < chance(math.sqrt(area_of(corners)), cosine, smear):
                noise = PIXEL_SD * self._rng.standard_normal((4, 2))
                found.append((marker.dictionary, marker.id, corners + noise))
        return tuple(found)
