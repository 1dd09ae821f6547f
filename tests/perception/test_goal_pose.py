from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import target

from missionkit.geometry import from_euler, multiply, to_matrix, vec
from missionkit.goal_pose import facing, goal_of, goal_rotation
from missionkit.messages import Target

angles = st.floats(-math.pi, math.pi)


@given(angles, angles, angles)
@settings(derandomize=True, database=None)
def test_the_goal_orientation_is_a_body_that_faces_the_marker(roll, pitch, yaw):
    marker = to_matrix(from_euler(roll, pitch, yaw))
    body = goal_rotation(marker)
    np.testing.assert_allclose(body.T @ body, np.eye(3), atol=1e-12)
    assert np.linalg.det(body) == pytest.approx(1.0)
    forward, right, down = body.T
    np.testing.assert_array_equal(forward, -marker[:, 2])  # against the marker's normal
    np.testing.assert_array_equal(right, marker[:, 0])
    np.testing.assert_array_equal(down, -marker[:, 1])


@given(angles, st.floats(0.5, 10), st.floats(-2, 2), st.floats(-2, 2))
@settings(derandomize=True, database=None)
def test_from_the_goal_the_marker_lies_straight_ahead(yaw, out, right, up):
    trunk = target(position=(84.0, 12.0, -2.5), yaw=yaw)
    goal = goal_of(trunk, (out, right, up), 7.0)
    ahead = vec(math.cos(goal.yaw), math.sin(goal.yaw), 0.0)
    rightwards = vec(-math.sin(goal.yaw), math.cos(goal.yaw), 0.0)
    gap = trunk.position - goal.position
    assert gap @ ahead == pytest.approx(out)
    assert gap @ rightwards == pytest.approx(-right, abs=1e-9)
    assert gap[2] == pytest.approx(up)  # the vehicle is higher: the target lies below, + down
    assert (goal.at, goal.target) == (7.0, "trunk")


def test_a_marker_that_faces_south_is_served_from_the_south_looking_north():
    goal = goal_of(target(position=(84.0, 12.0, -2.5), yaw=math.pi), (1.2, 0.0, 0.0), 0.0)
    np.testing.assert_allclose(goal.position, [82.8, 12.0, -2.5])
    assert goal.yaw == pytest.approx(0.0, abs=1e-12)


def test_an_upright_marker_has_its_axes_right_up_and_out():
    axes = to_matrix(facing(math.pi / 2))  # faces east; the viewer looks west, right is north
    np.testing.assert_allclose(axes.T, [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-15)


def test_a_marker_on_the_ground_has_a_goal_above_it_and_no_yaw():
    flat = multiply(facing(0.0), from_euler(-math.pi / 2, 0.0, 0.0))
    np.testing.assert_allclose(to_matrix(flat)[:, 2], [0, 0, -1], atol=1e-12)
    goal = goal_of(Target("pad", vec(3, 4, 0), 0.1, flat, 0.1, None), (2.0, 0.0, 0.0), 0.0)
    np.testing.assert_allclose(goal.position, [3, 4, -2], atol=1e-12)
    assert goal.yaw is None


def test_without_an_orientation_there_is_no_goal():
    assert goal_of(target(yaw=None), (1.2, 0.0, 0.0), 0.0) is None
