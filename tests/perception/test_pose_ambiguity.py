from __future__ import annotations

import math

import numpy as np
import pytest
from scenes import CAMERA, LEVEL, corners_of, marker_at, noisy, seen_from, tilted

from missionkit.geometry import Transform, exp, from_euler, multiply, vec
from missionkit.goal_pose import facing
from missionkit.perception.pose_ambiguity import Expectation, cost, resolve
from missionkit.perception.square_pose import Solution, angle_between, solve

SIZE = 0.4
CAMERA_TO_WORLD = (LEVEL @ CAMERA.mount).rotation


def solutions(truth, seed, sigma=0.3):
    return solve(noisy(corners_of(truth, SIZE), np.random.default_rng(seed), sigma), SIZE, CAMERA)


def wrongly_sure(truth, expected, draws=60):
    """Return how many draws end more than 15 deg off with an orientation that counts."""
    answers = [resolve(solutions(truth, seed), expected) for seed in range(draws)]
    off = [angle_between(s.pose.rotation, truth.rotation) > math.radians(15) for s, _ in answers]
    open_ = [ambiguous for _, ambiguous in answers]
    return sum(o and not a for o, a in zip(off, open_, strict=True)), sum(open_)


def test_a_clear_view_needs_no_prior():
    assert wrongly_sure(tilted(2.0, turn_deg=35.0), Expectation()) == (0, 0)


def test_a_distant_marker_is_called_ambiguous_rather_than_guessed():
    wrong, undecided = wrongly_sure(tilted(7.0, turn_deg=12.0), Expectation())
    assert undecided > 30
    assert wrong <= 3


def test_the_previous_orientation_decides_between_left_and_right():
    truth = seen_from(LEVEL, marker_at(7.0, 0.0, 0.0, yaw=math.radians(180 - 15)))
    prior = Expectation(CAMERA_TO_WORLD, True, facing(math.radians(180 - 13)), math.radians(5))
    assert wrongly_sure(truth, Expectation(CAMERA_TO_WORLD, upright=True))[1] > 30
    assert wrongly_sure(truth, prior) == (0, 0)


def test_gravity_decides_between_up_and_down():
    """The vehicle looks up at a hanging marker: nodded 25 deg in the image, or hanging straight."""
    body = Transform(from_euler(0.0, math.radians(25), 0.0), vec(0, 0, 0))
    camera = (body @ CAMERA.mount).rotation
    truth = seen_from(body, marker_at(7.0, 0.0, -7.0 * math.tan(math.radians(25))))
    assert wrongly_sure(truth, Expectation(camera, upright=False))[1] > 10
    wrong, undecided = wrongly_sure(truth, Expectation(camera, upright=True))
    assert wrong == 0
    assert undecided <= 2


def test_a_wrong_prior_does_not_outvote_a_clear_image():
    truth = seen_from(LEVEL, marker_at(2.0, 0.0, 0.0, yaw=math.radians(180 - 40)))
    wrong = Expectation(CAMERA_TO_WORLD, True, facing(math.radians(180 + 40)), math.radians(5))
    assert wrongly_sure(truth, wrong)[0] == 0


def test_a_marker_on_the_ground_is_beyond_the_rule_for_upright_ones():
    flat = Solution(Transform(exp(vec(0, 0, 0)), vec(0, 0, 3)), 0.1)
    nodded = Solution(Transform(exp(vec(0.1, 0, 0)), vec(0, 0, 3)), 0.1)
    camera = from_euler(0.0, 0.0, 0.0)  # marker's z axis down or nearly so: y axis horizontal
    expected = Expectation(camera, upright=True)
    assert cost(flat, 0.3, expected) == cost(nodded, 0.3, expected)


def test_a_prior_without_a_camera_attitude_says_nothing():
    one = Solution(tilted(3.0), 0.3)
    assert cost(one, 0.3, Expectation(None, True, facing(0.0), 0.1)) == pytest.approx(8.0)


def test_two_orientations_that_hardly_differ_need_no_choice():
    near = Solution(tilted(3.0), 0.1)
    turned = multiply(tilted(3.0).rotation, exp(vec(0.0, math.radians(1), 0.0)))
    other = Solution(Transform(turned, near.pose.translation), 0.1)
    assert resolve((near, other), Expectation()) == (near, False)
    far = Solution(tilted(3.0, turn_deg=20), 0.1)
    assert resolve((near, far), Expectation())[1]
