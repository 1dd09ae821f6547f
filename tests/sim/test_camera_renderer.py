"""The renderer draws what it is asked for, repeatably, and survives every pose."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from missionkit.geometry import Transform, from_matrix, normalised, vec
from missionkit.geometry import from_euler as euler
from missionkit.messages import CameraModel
from missionkit.sim.camera_renderer import Renderer
from missionkit.sim.lens_model import LONGEST_STREAK, streak
from missionkit.sim.world import World

STILL = np.zeros(3)
MATRIX = np.array([[277.0, 0.0, 159.5], [0.0, 277.0, 119.5], [0.0, 0.0, 1.0]])
AXES = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # camera to body
ORCHARD = {
    "world": "test",
    "obstacles": [
        {"use": "cylinder", "at": (10.55, 0.2), "radius": 0.4, "height": 5.0},
        {"use": "cylinder", "at": (20.0, 6.0), "radius": 1.0, "height": 8.0},
        {"use": "box", "min": (14.0, -9.0), "max": (16.0, -4.0), "height": 6.0},
        {"use": "sphere", "at": (18.0, 3.0, -4.0), "radius": 1.5},
    ],
    "markers": [
        {"dictionary": "DICT_6X6_250", "id": 23, "size": 0.4, "position": (10.1, 0.2, -3.0)},
        {"dictionary": "DICT_4X4_50", "id": 3, "size": 0.8, "position": (3, 0, 0), "tilt_deg": 90},
    ],
}
AHEAD = Transform(euler(0.0, 0.0, 0.0), vec(8.0, 0.2, -3.0))


def renderer(seed: int = 1, **world: object) -> Renderer:
    camera = CameraModel(
        320, 240, MATRIX, np.zeros(5), Transform(from_matrix(AXES), np.zeros(3)), 0.05
    )
    scene = World.model_validate({**ORCHARD, **world})
    return Renderer(scene, camera, np.random.default_rng(seed))


def found(image, dictionary: int = cv2.aruco.DICT_6X6_250) -> list[int]:
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(dictionary))
    ids = detector.detectMarkers(image)[1]
    return [] if ids is None else ids.ravel().tolist()


def sky(image):
    return cv2.GaussianBlur(image, (0, 0), 2.0) > 157


@pytest.mark.parametrize("down", [-0.5, -0.05, 0.0, 0.05, 0.5, 3.0])
@pytest.mark.parametrize("pitch", [0.0, -1.5, 1.5])
def test_a_level_camera_on_the_ground_or_below_it_draws_too(down, pitch):
    """A vehicle may say that it is below home."""
    body = Transform(euler(0.0, pitch, 0.0), vec(0.0, 0.0, down))
    moving = vec(1.0, 0.0, 0.5)
    frame = renderer(markers=[], obstacles=[]).render(body, moving, STILL, 0.01)
    assert frame.shape == (240, 320)


def test_same_seed_same_frames_and_no_two_frames_alike():
    one, two, other = renderer(7), renderer(7), renderer(8)
    frames = [[r.render(AHEAD, STILL, STILL, 0.01) for _ in range(3)] for r in (one, two, other)]
    assert np.array_equal(frames[0], frames[1])
    assert not np.array_equal(frames[0], frames[2])
    assert not np.array_equal(frames[0][0], frames[0][1])


def test_marker_is_seen_unless_hidden_or_from_behind():
    eye = renderer()
    assert found(eye.render(AHEAD, STILL, STILL, 0.0)) == [23]
    assert found(eye.render(AHEAD, STILL, STILL, 0.0, frozenset({23}))) == []
    back = Transform(euler(0.0, 0.0, np.pi), vec(12.0, 0.2, -3.0))
    bare = renderer(obstacles=[])
    behind = bare.render(back, STILL, STILL, 0.0)
    assert found(behind) == found(behind[:, ::-1].copy()) == []
    away = Transform(euler(0.0, 0.0, np.pi), AHEAD.translation)
    plain = renderer(obstacles=[], markers=[])
    nothing = plain.render(away, STILL, STILL, 0.0).astype(float)
    assert np.abs(renderer(obstacles=[]).render(away, STILL, STILL, 0.0) - nothing).max() < 1.0


def test_marker_on_the_ground_is_read_from_above():
    over = Transform(euler(0.0, -np.pi / 2, 0.0), vec(3.0, 0.0, -3.0))
    assert found(renderer().render(over, STILL, STILL, 0.0), cv2.aruco.DICT_4X4_50) == [3]


def test_horizon_rises_on_the_right_when_rolled_to_the_right():
    bare = renderer(obstacles=[], markers=[])
    at = Transform(euler(0.3, 0.0, 0.0), vec(0.0, 0.0, -5.0))
    bright = sky(bare.render(at, STILL, STILL, 0.0))
    left, right = bright[:, 40].sum(), bright[:, 280].sum()
    assert (left - right) / 240 == pytest.approx(np.tan(0.3), abs=0.04)


def test_horizon_sinks_when_pitched_up():
    bare = renderer(obstacles=[], markers=[])
    at = Transform(euler(0.0, 0.2, 0.0), vec(0.0, 0.0, -5.0))
    above = sky(bare.render(at, STILL, STILL, 0.0))[:, 160].sum()
    assert above == pytest.approx(119.5 + 277 * np.tan(0.2), abs=4)


def test_blur_grows_with_rates_and_speed():
    def sharpness(velocity, rates) -> float:
        image = renderer().render(AHEAD, velocity, rates, 0.02)
        return float(cv2.Sobel(image[60:180, 100:220], cv2.CV_32F, 1, 0).std())

    still = sharpness(STILL, STILL)
    turning = [sharpness(STILL, vec(0.0, 0.0, rate)) for rate in (0.5, 1.0, 2.0)]
    assert still > turning[0] > turning[1] > turning[2]
    assert sharpness(vec(0.0, 2.0, 0.0), STILL) < 0.9 * still
    assert sharpness(vec(0.2, 0.0, 0.0), STILL) == pytest.approx(still, rel=0.03)


@pytest.mark.parametrize("motion", [(3.0, 0.0), (-2.0, 5.0), (0.0, 9.9), (12.0, -7.0), (300.0, 1)])
def test_streaks_keep_the_brightness_and_the_place(motion):
    x = y = spread = 0.0
    for kernel in streak(*motion):
        i, j = np.indices(kernel.shape) - kernel.shape[0] // 2
        assert kernel.sum() == pytest.approx(1.0, abs=1e-5)
        x, y = x + (kernel * j).sum(), y + (kernel * i).sum()
        spread += (kernel * (i**2 + j**2)).sum()
    length = min(np.hypot(*motion), LONGEST_STREAK)
    assert (x, y) == pytest.approx((0.0, 0.0), abs=1e-4)
    assert np.sqrt(12 * spread) == pytest.approx(length, rel=0.2)


def test_no_streak_below_half_a_pixel():
    assert streak(0.3, 0.3) == []


def test_every_pose_gives_an_image():
    rng = np.random.default_rng(3)
    eye = renderer()
    poses = [
        Transform(normalised(rng.standard_normal(4)), rng.uniform((-5, -10, -12), (25, 10, 1)))
        for _ in range(200)
    ]
    level = [
        Transform(euler(0.0, pitch, 0.0), place)
        for pitch in (-np.pi / 2, 0.0, np.pi / 2)
        for place in (
            vec(10.55, 0.2, -2.0),  # inside a trunk
            vec(15.0, -6.0, -3.0),  # inside a box
            vec(18.0, 3.0, -4.0),  # in the middle of a ball
            vec(10.1, 0.2, -3.0),  # in a marker
            vec(3.0, 0.0, 0.0),  # on the ground, in a marker
            vec(0.0, 0.0, 2.0),  # below the ground
            vec(0.0, 0.0, -9000.0),
            vec(1e5, -1e5, -20.0),
        )
    ]
    for pose in poses + level:
        image = eye.render(pose, rng.uniform(-9, 9, 3), rng.uniform(-5, 5, 3), 0.01)
        assert image.shape == (240, 320)
        assert image.dtype == np.uint8
        assert 20 < image.mean() < 245
