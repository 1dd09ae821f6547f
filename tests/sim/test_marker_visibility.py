from __future__ import annotations

import math

import cv2
import numpy as np
import pytest

from missionkit.geometry import from_euler, vec
from missionkit.perception.camera_section import Camera, Mount
from missionkit.sim.marker_visibility import (
    Spotter,
    area_of,
    chance,
    image_speed,
    lens_of,
    outline,
    project,
)
from missionkit.sim.obstacle_distance import table
from missionkit.sim.world import Cylinder, Marker, World

FRONT = Marker(dictionary="DICT_4X4_50", id=3, size=0.5, position=(4.0, 0.0, -2.0), facing_deg=180)


def state_at(yaw: float = 0.0, north: float = 0.0) -> np.ndarray:
    state = np.zeros(13)
    state[:3] = north, 0.0, -2.0
    state[6:10] = from_euler(0.0, 0.0, yaw)
    return state


def spot(
    state: np.ndarray, *obstacles: Cylinder, marker: Marker = FRONT, hidden: int = -1
) -> tuple[tuple[str, int, np.ndarray], ...]:
    camera = Camera(use="corners", mount=Mount(position=(0.0, 0.0, 0.0))).model()
    things = table(World(world="test", obstacles=obstacles))
    spotter = Spotter((marker,), camera, things, np.random.default_rng(4))
    return spotter.find(state, 0.0, frozenset({hidden}))


def test_projection_is_that_of_opencv(rng: np.random.Generator) -> None:
    camera = Camera(use="corners", focal=500.0, distortion=(-0.2, 0.05, 1e-3, -2e-3, 0.01)).model()
    points = rng.uniform((-1, -1, 2), (1, 1, 6), (20, 3))
    expected, _ = cv2.projectPoints(
        points, np.zeros(3), np.zeros(3), camera.matrix, camera.distortion
    )
    ours = [project(point, lens_of(camera)) for point in points]
    assert np.array(ours) == pytest.approx(expected[:, 0], abs=1e-6)


def test_marker_ahead_gives_corners_clockwise_from_the_top_left() -> None:
    ((dictionary, number, corners),) = spot(state_at())
    half, middle = 554.0 * 0.25 / 4.0, np.array([319.5, 239.5])
    ideal = middle + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    assert (dictionary, number) == ("DICT_4X4_50", 3)
    assert corners == pytest.approx(ideal, abs=1.2)
    assert not np.array_equal(corners, ideal)


@pytest.mark.parametrize(
    ("state", "marker"),
    [
        (state_at(yaw=math.pi), FRONT),
        (state_at(north=8.0, yaw=math.pi), FRONT),
        (state_at(yaw=0.5), FRONT),
        (state_at(north=-40.0), FRONT),
        (state_at(), FRONT.model_copy(update={"facing_deg": 95.0})),
    ],
    ids=["behind", "from the back", "cut by the edge", "too far", "too oblique"],
)
def test_marker_is_not_seen(state: np.ndarray, marker: Marker) -> None:
    assert spot(state, marker=marker) == ()


def test_hidden_or_occluded_marker_is_not_seen() -> None:
    trunk = Cylinder(use="cylinder", at=(2.0, 0.0), radius=0.2, height=5.0)
    behind = Cylinder(use="cylinder", at=(4.33, 0.0), radius=0.3, height=5.0)
    assert spot(state_at(), trunk) == ()
    assert spot(state_at(), hidden=3) == ()
    assert len(spot(state_at(), behind)) == 1


def test_outline_stands_upright_facing_the_viewer() -> None:
    centre, top_left, top_right, _, _ = outline(FRONT)
    assert centre == pytest.approx(vec(4.0, 0.0, -2.0))
    assert top_left == pytest.approx(vec(4.0, -0.25, -2.25))
    assert top_right == pytest.approx(vec(4.0, 0.25, -2.25))


def test_chance_falls_with_range_obliquity_and_blur() -> None:
    assert chance(60.0, 1.0, 0.0) == pytest.approx(0.99, abs=0.001)
    assert chance(14.0, 1.0, 0.0) == pytest.approx(0.495, abs=0.003)
    assert chance(60.0, 0.1, 0.0) < 0.05
    assert chance(60.0, 1.0, 20.0) < 0.01


def test_image_speed_of_translation_and_rotation() -> None:
    ahead, still = vec(0.0, 0.0, 5.0), vec(0.0, 0.0, 0.0)
    assert image_speed(ahead, vec(2.0, 0.0, 0.0), still) == pytest.approx(0.4)
    assert image_speed(ahead, still, vec(0.0, 0.3, 0.0)) == pytest.approx(0.3)
    assert image_speed(ahead, vec(0.0, 0.0, 3.0), vec(0.0, 0.0, 1.0)) == pytest.approx(0.0)


def test_area_of_a_square() -> None:
    assert area_of(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]])) == 9.0
