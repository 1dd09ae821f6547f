from __future__ import annotations

import math

import numpy as np
import pytest
from docking import WORLD, changed
from pydantic import ValidationError

from missionkit.docking_geometry import NORMALS, face_rotation, pose_error, turned
from missionkit.geometry import exp, rotate, to_matrix

DOWN = np.array([0.0, 0.0, 1.0])


def test_angles_turn_about_x_then_the_new_y_then_the_new_z():
    assert to_matrix(turned((-90.0, 0.0, -90.0))) == pytest.approx(
        np.column_stack(([0, 0, 1], [1, 0, 0], [0, 1, 0])), abs=1e-12
    )
    a, b, c = np.radians([20.0, -30.0, 50.0])
    about = [to_matrix(exp(v)) for v in np.diag([a, b, c])]
    assert to_matrix(turned((20.0, -30.0, 50.0))) == pytest.approx(about[0] @ about[1] @ about[2])


@pytest.mark.parametrize("face", NORMALS)
def test_a_docked_chaser_looks_into_the_face(face):
    assert rotate(face_rotation(face), DOWN) == pytest.approx(-np.array(NORMALS[face]), abs=1e-12)
    rolled = face_rotation(face, 90.0)
    assert rotate(rolled, DOWN) == pytest.approx(-np.array(NORMALS[face]), abs=1e-12)


def test_the_near_side_is_the_chaser_s_and_needs_the_target_s_attitude():
    berth = WORLD.berth
    assert berth.normal == pytest.approx([0.0, -1.0, 0.0], abs=1e-12)
    assert berth.pose.translation == pytest.approx([1.0, 1.9, 1.0])
    assert berth.pose.rotation == pytest.approx(WORLD.target.pose.rotation)
    start = turned(WORLD.start.attitude_deg)
    _, turn = pose_error(berth, np.zeros(3), start)
    assert math.sin(turn / 2.0) == pytest.approx(0.866, abs=1e-3)  # |q_e| where r2 = 0.63 m


def test_the_far_side_is_another_face_of_the_world_file():
    far = changed(target={**WORLD.target.model_dump(), "face": "bottom"}).berth
    assert far.normal == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert far.pose.translation == pytest.approx([1.0, 2.1, 1.0])
    assert rotate(far.pose.rotation, DOWN) == pytest.approx([0.0, -1.0, 0.0], abs=1e-12)


@pytest.mark.parametrize(
    ("out", "aside", "inside"),
    [
        *((0.0, 0.0, True), (0.0, 0.029, True), (0.0, 0.031, False), (0.1, 0.066, True)),
        *((0.1, 0.067, False), (0.29, 0.1, True), (0.31, 0.0, False), (-0.019, 0.0, True)),
        (-0.021, 0.0, False),
    ],
)
def test_the_corridor_is_a_blunt_cone(out, aside, inside):
    berth = WORLD.berth
    across = rotate(berth.pose.rotation, np.array([0.6, 0.8, 0.0]))
    place = berth.pose.translation + out * berth.normal + aside * across
    seen = WORLD.cone.sideways(berth, place)
    assert (seen is not None) is inside
    if seen is not None:
        assert seen == pytest.approx(aside, abs=1e-12)


@pytest.mark.parametrize(
    ("part", "complaint"),
    [
        ({"start": {"position": (1.0, 1.83, 1.0)}}, "starts 0.17 m from the target, where 0.174 m"),
        ({"target": {"face": "north"}}, "'front', 'back', 'right', 'left', 'bottom' or 'top'"),
        ({"vehicle": {"use": "quadrotor"}}, "free_flyer"),
        ({"vehicle": {"mass": 0.0}}, "greater than 0"),
        ({"anchors": {"a-1": (0.0, 0.0, 0.0)}}, "pattern"),
        ({"anchors": {"a1": (0.0, 0.0, float("nan"))}}, "finite"),
        ({"obstacles": []}, "Extra inputs"),
    ],
)
def test_mistakes_in_a_world_are_refused(part, complaint):
    with pytest.raises(ValidationError, match=complaint):
        changed(**part)
