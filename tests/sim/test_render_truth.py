"""The rendered image agrees with `cv2.projectPoints`: corners, lens, order of what is in front."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest

from missionkit.geometry import Transform, from_euler, from_matrix, to_matrix, vec
from missionkit.messages import CameraModel
from missionkit.sim.camera_renderer import Renderer
from missionkit.sim.world import World

AXES = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # camera to body
MATRIX = np.array([[554.0, 0.0, 321.3], [0.0, 549.0, 238.1], [0.0, 0.0, 1.0]])
STRAIGHT = (0.0, 0.0, 0.0, 0.0, 0.0)
BARREL = (-0.28, 0.08, 0.001, -0.0005, 0.01)
STILL = np.zeros(3)
MARKER = {
    "dictionary": "DICT_6X6_250",
    "id": 23,
    "size": 0.4,
    "position": (10.0, 0.0, -3.0),
    "facing_deg": 180,
    "tilt_deg": 4,
    "roll_deg": 8,
}
DETECTOR = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_6X6_250))


def camera(distortion: tuple[float, ...] = STRAIGHT) -> CameraModel:
    mount = Transform(from_matrix(AXES), vec(0.1, 0.0, 0.05))
    return CameraModel(640, 480, MATRIX, np.array(distortion), mount, 0.05)


def renderer(distortion: tuple[float, ...] = STRAIGHT, **world: object) -> Renderer:
    scene = World.model_validate({"world": "test", "markers": [MARKER], **world})
    return Renderer(scene, camera(distortion), np.random.default_rng(5))


def body(n: float, e: float, d: float, roll: float = 0, pitch: float = 0, yaw: float = 0):
    return Transform(from_euler(roll, pitch, yaw), vec(n, e, d))


def found(image) -> list[int]:
    ids = DETECTOR.detectMarkers(image)[1]
    return [] if ids is None else sorted(ids.ravel().tolist())


def true_corners(at: Transform, model: CameraModel):
    """Project the marker's corners (4, 2), px, as a camera without distortion sees them."""
    marker = World.model_validate({"world": "test", "markers": [MARKER]}).markers[0]
    square = 0.2 * np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]])
    points = np.array([marker.pose.apply(corner) for corner in square])
    eye = (at @ model.mount).inverse()
    turn = cv2.Rodrigues(to_matrix(eye.rotation))[0]
    return cv2.projectPoints(points, turn, eye.translation, model.matrix, None)[0][:, 0]


def edge_points(image, a, b, level: float, reach: float):
    """Return two points (2, 2) where the brightness across the side a-b passes `level`."""
    side = np.linalg.norm(b - a)
    outward = np.array([b[1] - a[1], a[0] - b[0]]) / side  # clockwise corners, y points down
    steps = np.linspace(-reach, reach, 41)
    spots = np.linspace(0.12, 0.88, 60)[:, None, None]
    at = (a + spots * (b - a) + steps[None, :, None] * outward).astype(np.float32)
    profiles = cv2.remap(image.astype(np.float32), at, None, cv2.INTER_CUBIC)
    points = []
    for half in (slice(0, 30), slice(30, 60)):
        mean = profiles[half].mean(axis=0) - level
        rises = np.flatnonzero((mean[:-1] <= 0) & (mean[1:] > 0))
        k = min(rises, key=lambda rise: abs(rise - 20))
        shift = np.interp(0.0, mean[k : k + 2], steps[k : k + 2])
        points.append(a + spots[half, 0].mean() * (b - a) + shift * outward)
    return points


def edge_corners(image, corners):
    """Refine corners (4, 2) as meeting points of the edges: cornerSubPix pulls them inwards."""
    x, y, wide, high = cv2.boundingRect(corners.astype(np.float32))
    level = np.quantile(image[y : y + high, x : x + wide], [0.05, 0.95]).mean()
    reach = min(4.0, 0.9 * min(wide, high) / 8)
    for _ in range(4):
        pairs = zip(corners, np.roll(corners, -1, axis=0), strict=True)
        sides = [edge_points(image, a, b, level, reach) for a, b in pairs]
        lines = [np.cross([*p, 1.0], [*q, 1.0]) for p, q in sides]
        meets = [np.cross(lines[i - 1], lines[i]) for i in range(4)]
        corners = np.array([m[:2] / m[2] for m in meets])
    return corners


def around(rng: np.random.Generator, gap: float) -> Transform:
    """Return a body `gap` metres from the marker, up to 60 degrees aside, facing it roughly."""
    side, up = rng.uniform(-1, 1) * min(1.05, 4.0 / gap), rng.uniform(-0.1, 0.3)
    n, e = 10 - gap * math.cos(side) * math.cos(up), gap * math.sin(side) * math.cos(up)
    yaw = math.atan2(-e, 10 - n) + rng.uniform(-0.12, 0.12)
    roll, pitch = rng.uniform(-0.25, 0.25), -up + rng.uniform(-0.08, 0.08)
    return body(n, e, -3 - gap * math.sin(up), roll, pitch, yaw)


@pytest.mark.parametrize("distortion", [STRAIGHT, BARREL])
def test_marker_corners_are_where_opencv_projects_them(distortion):
    rng = np.random.default_rng(2)
    eye, model = renderer(distortion), camera(distortion)
    errors, outwards = [], []
    for gap in np.linspace(1.2, 9.0, 40):
        at = around(rng, gap)
        image = cv2.undistort(eye.render(at, STILL, STILL, 0.0), MATRIX, np.array(distortion))
        corners, ids, _ = DETECTOR.detectMarkers(image)
        assert ids is not None, f"not detected at {gap:.1f} m"
        truth = true_corners(at, model)
        error = edge_corners(image, corners[0][0].astype(np.float64)) - truth
        outward = truth - truth.mean(axis=0)
        outward /= np.linalg.norm(outward, axis=1, keepdims=True)
        errors.append(error)
        outwards.append((error * outward).sum(axis=1).mean())
    errors = np.array(errors)
    size = np.linalg.norm(errors, axis=2)
    assert size.max() < 0.15
    assert np.sqrt((size**2).mean()) < 0.06
    assert np.abs(errors.mean(axis=(0, 1))).max() < 0.01
    assert abs(np.mean(outwards)) < 0.02


def test_motion_blur_does_not_shift_the_marker():
    eye, at = renderer(), body(7.0, 0.0, -3.0)
    truth = true_corners(at, camera())
    errors = []
    for _ in range(10):
        image = eye.render(at, vec(0.0, 0.8, -0.5), vec(0.1, 0.3, 0.4), 0.01)
        errors.append(edge_corners(image, truth) - truth)
    assert np.abs(np.mean(errors, axis=(0, 1))).max() < 0.02


@pytest.mark.parametrize("north", [0.0, -3000.0, *np.arange(76.0, 90.0, 0.7)])
def test_texture_of_the_ground_stays_on_the_ground(north):
    """Track grass between two views: it moves as the plane down = 0 does, across tiles too."""
    model = camera()
    first = body(north, 0.0, -5.0, 0.05, -1.2, 0.3)
    second = body(north + 0.4, -0.3, -4.8, 0.0, -1.25, 0.33)
    homographies = []
    for at in (first, second):
        eye = at @ model.mount
        turn = to_matrix(eye.rotation).T
        homographies.append(
            MATRIX @ np.column_stack([turn[:, 0], turn[:, 1], -turn @ eye.translation])
        )
    eye = renderer(markers=[])
    images = [eye.render(at, STILL, STILL, 0.0) for at in (first, second)]
    u, v = np.meshgrid(np.arange(120, 540, 40.0), np.arange(120, 400, 40.0))
    start = np.stack([u.ravel(), v.ravel()], axis=1)[:, None].astype(np.float32)
    truth = cv2.perspectiveTransform(start, homographies[1] @ np.linalg.inv(homographies[0]))
    track = cv2.calcOpticalFlowPyrLK(*images, start, None, winSize=(31, 31), maxLevel=4)[0]
    error = np.linalg.norm(track - truth, axis=2)
    assert np.linalg.norm(truth - start, axis=2).min() > 15.0
    assert np.median(error) < 0.3
    assert np.abs(np.median(track - truth, axis=0)).max() < 0.1


@pytest.mark.parametrize(
    ("obstacle", "seen"),
    [
        ({"use": "cylinder", "at": (8.0, 0.0), "radius": 0.4, "height": 5.0}, []),
        ({"use": "cylinder", "at": (10.45, 0.0), "radius": 0.4, "height": 5.0}, [23]),
        ({"use": "box", "min": (10.02, -9.0), "max": (11.0, 1.0), "height": 6.0}, [23]),
        ({"use": "box", "min": (7.0, -1.0), "max": (8.0, 3.0), "height": 6.0}, []),
        ({"use": "box", "min": (7.0, -1.0), "max": (8.0, 3.0), "height": 6.0, "bottom": 5.0}, [23]),
        ({"use": "sphere", "at": (8.5, 0.0, -3.0), "radius": 0.5}, []),
        ({"use": "sphere", "at": (11.0, 0.0, -3.0), "radius": 0.5}, [23]),
    ],
)
@pytest.mark.parametrize("east", [-0.4, 0.0, 0.4])
def test_near_surfaces_hide_far_ones(obstacle, seen, east):
    eye = renderer(obstacles=[obstacle])
    at = body(5.0, east, -3.0, yaw=math.atan2(-east, 5.0))
    assert found(eye.render(at, STILL, STILL, 0.0)) == seen


@pytest.mark.parametrize("east", [-4.0, 3.0])
@pytest.mark.parametrize(
    "bearer",
    [
        {"use": "cylinder", "at": (10.45, 0.0), "radius": 0.4, "height": 5.0},
        {"use": "box", "min": (10.02, -20.0), "max": (13.0, 1.0), "height": 6.0},
    ],
)
def test_marker_is_seen_on_its_bearer_from_aside(bearer, east):
    eye = renderer(obstacles=[bearer])
    at = body(7.0, east, -3.0, yaw=math.atan2(-east, 3.0))
    assert found(eye.render(at, STILL, STILL, 0.0)) == [23]
