"""Places on the ground from pixels: against projection, sampled errors, and P4's Jacobian."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.geometry import Transform, from_euler, multiply, to_matrix, vec
from missionkit.messages import BoxDetection
from missionkit.perception.camera_section import Camera, Mount
from missionkit.perception.ground_plane import ViewNoise, on_ground, view_of
from missionkit.perception.square_pose import project

CAMERA = Camera(
    width=320, height=240, focal=277.0, distortion=(0.05, -0.02, 1e-3, -1e-3, 0.0),
    mount=Mount(position=(0.05, 0.0, 0.02), tilt_deg=80.0),
).model()  # fmt: skip
GROUND = 0.4
DIAMETER = 0.34
EXACT = ViewNoise(pixel=1.5)


def body_at(seed: int) -> Transform:
    rng = np.random.default_rng(seed)
    turn = from_euler(*rng.normal(0.0, 0.1, 2), rng.uniform(-3.0, 3.0))
    return Transform(turn, np.array([*rng.uniform(-5.0, 5.0, 2), GROUND - 2.5]))


def box(pixel, side: float = 40.0) -> BoxDetection:
    return BoxDetection("haar", np.asarray(pixel, dtype=float), (side, side), 0.8)


def pixel_of(place, body: Transform):
    eye = (body @ CAMERA.mount).inverse()
    return project(np.array([[*place, GROUND]]), eye, CAMERA)[0]


@pytest.mark.parametrize("seed", range(8))
def test_what_is_projected_comes_back(seed):
    body = body_at(seed)
    place = body.translation[:2] + np.random.default_rng(seed).uniform(-0.6, 0.6, 2)
    seen = on_ground(box(pixel_of(place, body)), CAMERA, body, GROUND, EXACT, DIAMETER)
    assert seen is not None
    assert seen.position == pytest.approx(place, abs=1e-4)


def test_the_covariance_is_that_of_sampled_errors():
    body, rng = body_at(3), np.random.default_rng(0)
    noise = ViewNoise(pixel=1.5, position=0.05, height=0.08, attitude=0.02)
    pixel = np.array([230.0, 190.0])
    seen = on_ground(box(pixel), CAMERA, body, GROUND, noise, DIAMETER)
    places = []
    for _ in range(4000):
        turn = np.array((1.0, *(0.5 * rng.normal(0.0, noise.attitude, 3))))
        rotation = multiply(turn / np.linalg.norm(turn), body.rotation)
        shift = rng.normal(0.0, 1.0, 3) * (noise.position, noise.position, noise.height)
        off = Transform(rotation, body.translation + shift)
        at = box(pixel + rng.normal(0.0, noise.pixel, 2))
        places.append(on_ground(at, CAMERA, off, GROUND, EXACT, DIAMETER).position)
    assert np.cov(np.array(places).T) == pytest.approx(seen.covariance, rel=0.1, abs=2e-4)


def test_it_is_as_certain_as_p4_s_filter_in_pixels():
    """H of P4 (11) mended, with its axes: x along the optical axis; Hᵀ R⁻¹ H is what z says."""
    plain = Camera(width=320, height=240, focal=277.0, mount=Mount(tilt_deg=75.0)).model()
    body = body_at(5)
    pixel = np.array([100.0, 150.0])
    seen = on_ground(box(pixel), plain, body, GROUND, EXACT, DIAMETER)
    eye = body @ plain.mount
    world_to_camera = to_matrix(eye.rotation).T  # OpenCV's: x right, y down, z ahead
    x, y, z = world_to_camera @ (np.array([*seen.position, GROUND]) - eye.translation)
    f = 277.0
    H = np.array([[f / z, 0.0, -f * x / z**2], [0.0, f / z, -f * y / z**2]]) @ world_to_camera
    information = H[:, :2].T @ H[:, :2] / 1.5**2
    np.testing.assert_allclose(np.linalg.inv(seen.covariance), information, rtol=1e-9)


def test_a_robot_s_own_size_is_one_at_every_height():
    for height in (1.5, 2.5, 4.0):
        body = Transform(from_euler(0.0, 0.0, 0.0), vec(0.0, 0.0, -height))
        level = Camera(width=320, height=240, focal=277.0, mount=Mount(tilt_deg=90.0)).model()
        side = 277.0 * DIAMETER / height  # P4 (7)
        seen = on_ground(box((200.0, 60.0), side), level, body, 0.0, EXACT, DIAMETER)
        assert seen.size == pytest.approx(1.0, rel=0.05)  # the camera is 0.1 m ahead of the body
        assert seen.height == pytest.approx(height)


@pytest.mark.parametrize("roll", [math.pi, 1.5])
def test_a_pixel_that_does_not_meet_the_ground_is_nowhere(roll):
    body = Transform(from_euler(roll, 0.0, 0.0), vec(0.0, 0.0, -2.0))
    assert on_ground(box((160.0, 120.0)), CAMERA, body, 0.0, EXACT, DIAMETER) is None
    assert view_of(CAMERA, body, 0.0) is None
    below = Transform(from_euler(0.0, 0.0, 0.0), vec(0.0, 0.0, 1.0))
    assert on_ground(box((160.0, 120.0)), CAMERA, below, 0.0, EXACT, DIAMETER) is None


def test_the_view_is_what_the_corners_see():
    level = Camera(
        width=320, height=240, focal=277.0, mount=Mount(position=(0, 0, 0), tilt_deg=90.0)
    ).model()
    body = Transform(from_euler(0.0, 0.0, 0.0), vec(3.0, 1.0, -2.5))
    corners = view_of(level, body, 0.0)
    assert np.ptp(corners, axis=0) == pytest.approx(2.5 / 277.0 * np.array([239.0, 319.0]))
    assert corners.mean(axis=0) == pytest.approx([3.0, 1.0])
