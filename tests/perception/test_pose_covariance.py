from __future__ import annotations

import math

import numpy as np
import pytest
from scenes import CAMERA, corners_of, noisy, tilted

from missionkit.geometry import Transform, conjugate, log, multiply, vec
from missionkit.perception.pose_covariance import (
    covariance,
    deviations,
    head_on,
    pose_deviations,
)
from missionkit.perception.square_pose import Solution, angle_between, solve

SIZE = 0.4


@pytest.mark.parametrize(("distance", "turn"), [(2.0, 30.0), (5.0, 50.0)])
def test_the_covariance_is_what_repeated_measurement_shows(distance, turn):
    truth = tilted(distance, turn_deg=turn, nod_deg=10.0)
    truth = Transform(truth.rotation, vec(0.3, -0.2, distance))
    rng = np.random.default_rng(1)
    exact = corners_of(truth, SIZE)
    errors = []
    for _ in range(200):
        pose = solve(noisy(exact, rng), SIZE, CAMERA)[0].pose
        turned = log(multiply(pose.rotation, conjugate(truth.rotation)))
        errors.append(np.concatenate([turned, pose.translation - truth.translation]))
    claimed = covariance(truth, SIZE, CAMERA, 0.3)
    found = np.cov(np.array(errors).T)
    ratios = np.sqrt(np.diag(found) / np.diag(claimed))
    assert ((ratios > 1 / 1.5) & (ratios < 1.5)).all()
    for stated, seen in zip(deviations(claimed, truth), deviations(found, truth), strict=True):
        assert 1 / 1.5 < stated / seen < 1.5


def test_a_marker_seen_from_farther_away_is_less_well_known():
    stated = [deviations(covariance(p, SIZE, CAMERA, 0.3), p) for p in (tilted(2.0), tilted(4.0))]
    assert stated[1][0] == pytest.approx(4 * stated[0][0], rel=0.05)  # depth: Z² sigma / (f l)
    assert stated[1][1] > 3 * stated[0][1]


def test_corners_that_do_not_determine_the_pose_have_no_covariance():
    assert covariance(tilted(10.0), 1e-4, CAMERA, 0.3) is None
    assert pose_deviations(Solution(tilted(10.0), 0.1), 1e-4, CAMERA, 0.3, alone=True) is None


@pytest.mark.parametrize("turn", [0.0, 7.0, 14.0])
def test_the_claimed_angle_holds_near_head_on_where_the_two_poses_merge(turn):
    """A linear covariance alone claims up to eight times too much here."""
    rng, truth = np.random.default_rng(2), tilted(4.0, turn_deg=turn)
    exact, ratios = corners_of(truth, SIZE), []
    for _ in range(100):
        solutions = solve(noisy(exact, rng), SIZE, CAMERA)
        if len(solutions) == 1:
            (one,) = solutions
            _, claimed = pose_deviations(one, SIZE, CAMERA, max(0.3, one.error), alone=True)
            ratios.append(angle_between(one.pose.rotation, truth.rotation) / claimed)
    assert np.quantile(ratios, 0.95) < 3.0


def test_turning_head_on_keeps_the_place_and_returns_the_angle():
    pose, angle = head_on(tilted(3.0, turn_deg=25.0))
    assert math.degrees(angle) == pytest.approx(25.0)
    assert angle_between(pose.rotation, tilted(3.0).rotation) < 1e-7
    np.testing.assert_array_equal(pose.translation, [0, 0, 3])
    assert head_on(pose)[1] < 1e-7
