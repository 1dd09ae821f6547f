from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import CAMERA, corners_of, noisy, tilted
from scipy.optimize import least_squares

from missionkit.geometry import Transform, exp, multiply, to_matrix, vec
from missionkit.perception.camera_section import Camera
from missionkit.perception.square_pose import (
    angle_between,
    project,
    solve,
    square,
    turned_to_camera,
)

SIZE = 0.4
CURVED = Camera(distortion=(-0.05, 0.02, 0.001, -0.001, 0.0)).model()


@pytest.mark.parametrize("camera", [CAMERA, CURVED], ids=["straight lens", "curved lens"])
@given(
    turn=st.floats(-60, 60),
    nod=st.floats(-60, 60),
    roll=st.floats(-180, 180),
    place=st.tuples(st.floats(-0.3, 0.3), st.floats(-0.25, 0.25), st.floats(0.8, 9.0)),
)
@settings(max_examples=60, deadline=None, derandomize=True, database=None)
def test_the_pose_of_exact_corners_is_exact(camera, turn, nod, roll, place):
    x, y, z = place
    spin = exp(vec(0, 0, math.radians(roll)))
    head_on = tilted(z, turn_deg=turn, nod_deg=nod).rotation
    truth = Transform(multiply(head_on, spin), vec(x * z, y * z, z))
    solutions = solve(corners_of(truth, SIZE, camera), SIZE, camera)
    assert solutions[0].error < 1e-4
    np.testing.assert_allclose(solutions[0].pose.translation, truth.translation, atol=1e-4)
    assert angle_between(solutions[0].pose.rotation, truth.rotation) < 1e-3


@pytest.mark.parametrize("seed", range(6))
def test_the_refined_pose_is_the_least_squares_one(seed):
    """Against an independent minimiser that starts at the truth."""
    rng = np.random.default_rng(seed)
    truth = tilted(4.0, turn_deg=rng.uniform(20, 50), nod_deg=rng.uniform(-20, 20))
    corners = noisy(corners_of(truth, SIZE), rng)

    def residual(p):
        pose = Transform(multiply(exp(p[:3]), truth.rotation), truth.translation + p[3:])
        return (project(square(SIZE), pose, CAMERA) - corners).ravel()

    best = least_squares(residual, np.zeros(6), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    ours = solve(corners, SIZE, CAMERA)[0]
    assert ours.error == pytest.approx(math.sqrt(np.mean(best.fun**2)), rel=1e-5)
    np.testing.assert_allclose(ours.pose.translation, truth.translation + best.x[3:], atol=2e-4)
    assert angle_between(ours.pose.rotation, multiply(exp(best.x[:3]), truth.rotation)) < 1e-3


def test_a_small_square_has_two_poses_mirrored_about_the_line_of_sight():
    truth = tilted(8.0, turn_deg=15.0)
    corners = noisy(corners_of(truth, SIZE), np.random.default_rng(0), 0.02)
    one, other = solve(corners, SIZE, CAMERA)
    normals = [to_matrix(s.pose.rotation)[:, 2] for s in (one, other)]
    np.testing.assert_allclose(normals[0][0], -normals[1][0], atol=0.05)
    assert one.error < other.error < 0.3


@pytest.mark.parametrize(
    "corners",
    [
        np.full((4, 2), np.nan),
        np.array([[0.0, 0.0], [1.0, np.inf], [1.0, 1.0], [0.0, 1.0]]),
        np.array([[100.0, 100.0], [110.0, 110.0], [120.0, 120.0], [130.0, 130.0]]),
        np.array([[100.0, 100.0], [150.0, 100.0], [200.0, 100.0], [150.0, 150.0]]),
        np.zeros((4, 2)),
        np.array([[1.0, 1.0], [1e9, 2.0], [3.0, -1e9], [4.0, 4.0]]),
        np.zeros((3, 2)),
    ],
    ids=["nan", "infinite", "line", "three in line", "point", "absurd", "three"],
)
def test_corners_without_a_pose_give_none(corners):
    assert solve(corners, SIZE, CAMERA) == ()


def test_corners_the_wrong_way_round_are_turned_to_the_camera_by_the_papers_guard():
    mirrored = corners_of(tilted(3.0, turn_deg=20.0), SIZE)[::-1].copy()
    for solution in solve(mirrored, SIZE, CAMERA):
        assert not faces_us(solution.pose)
        assert faces_us(turned_to_camera(solution.pose))


def test_the_papers_guard_turns_a_marker_half_round_its_y_axis_and_leaves_others():
    seen = tilted(3.0, turn_deg=20.0)
    away = Transform(multiply(seen.rotation, np.array([0.0, 0.0, 1.0, 0.0])), seen.translation)
    assert not faces_us(away)
    assert angle_between(turned_to_camera(away).rotation, seen.rotation) < 1e-7
    np.testing.assert_array_equal(turned_to_camera(away).translation, seen.translation)
    assert turned_to_camera(seen) is seen


@pytest.mark.parametrize("roll", [0, 45, 90, 135, 180, 270])
def test_a_marker_straight_ahead_has_a_pose_at_any_roll(roll):
    """Here the rotation is by exactly pi, where OpenCV's IPPE_SQUARE fails."""
    spin = exp(vec(0, 0, math.radians(roll)))
    truth = Transform(multiply(tilted(2.0).rotation, spin), vec(0, 0, 2.0))
    (only,) = solve(corners_of(truth, SIZE), SIZE, CAMERA)
    np.testing.assert_allclose(only.pose.translation, truth.translation, atol=1e-6)
    assert angle_between(only.pose.rotation, truth.rotation) < 1e-4


def faces_us(pose):
    return to_matrix(pose.rotation)[:, 2] @ pose.translation < 0
