"""The placement study's closed form against a Riccati solver, and against the filter that flies."""

from __future__ import annotations

import numpy as np
import pytest
from rehearsed import MISSIONS
from scipy.linalg import solve_continuous_are

from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.estimation.tandem_ekf.filter import FlyerFilter
from missionkit.geometry import vec
from missionkit.messages import AnchorRange, Imu, Observation
from studies.placement import corners, poses, world
from studies.placement_model import (
    ACCEL_NOISE,
    RANGE_RATE,
    RANGE_SD,
    covariances,
    grid_of,
    largest_sd,
    outlook,
    worst_sd,
)

PAPER = np.array([(1, -0.2, 0.5), (1, 0.2, -0.5), (-1, 0.2, -0.5), (-1, -0.2, 0.5)])
TARGET, AXIS = vec(1.0, 2.0, 1.0), vec(0.0, -1.0, 0.0)


@pytest.mark.parametrize("place", [(0.0, 1.0, 0.0), (0.9, 1.9, 0.9), (-0.7, 0.6, 0.4)])
def test_the_closed_form_solves_the_riccati_equation(place):
    away = np.array(place) - PAPER
    unit = away / np.linalg.norm(away, axis=1, keepdims=True)
    H = np.hstack([unit, np.zeros((4, 3))])
    A, Q = np.zeros((6, 6)), np.zeros((6, 6))
    A[:3, 3:], Q[3:, 3:] = np.eye(3), ACCEL_NOISE**2 * np.eye(3)
    R = 4.0 * RANGE_SD**2 / RANGE_RATE * np.eye(4)
    wanted = solve_continuous_are(A.T, H.T, Q, R)[:3, :3]
    np.testing.assert_allclose(
        covariances(np.array([place]), PAPER)[0], wanted, rtol=1e-6, atol=1e-12
    )


def test_the_flown_filter_comes_to_the_same_deviation():
    mission = load(MISSIONS / "docking.yaml", builtin(), {"accel_noise": str(ACCEL_NOISE)})
    settings = mission.navigation.plugin
    navigator = FlyerFilter(settings, {})
    known, place = navigator.begin(), np.array([0.0, 1.0, 0.0])
    radio = place + np.array(settings.radio)
    names = list(settings.anchors)
    for n in range(1, 601):
        at = 0.02 * n
        imu = tuple(Imu(t, vec(0, 0, 0), vec(0, 0, 0)) for t in (at - 0.01, at))
        name = names[n % 4]
        far = float(np.linalg.norm(radio - np.array(settings.anchors[name])))
        known = navigator.propagate(
            known, Observation(at, imu=imu, ranges=(AnchorRange(at, name, far),))
        )
    sd = np.sqrt(np.diagonal(known.P)[:3].max())
    assert sd == pytest.approx(largest_sd(np.array([radio]), PAPER)[0], rel=0.1)


def test_with_an_anchor_lost_no_place_is_known_better():
    places = np.array([pose.place for pose in poses(50, world())])
    assert (worst_sd(places, PAPER) > largest_sd(places, PAPER)).all()


def test_a_grid_gives_what_is_computed_at_the_place():
    places = np.array([pose.place for pose in poses(50, world())])
    grid = grid_of([tuple(row) for row in PAPER])
    np.testing.assert_allclose(grid.best(places), largest_sd(places, PAPER), rtol=0.02)


def test_a_better_known_place_comes_round_later():
    r1 = [
        outlook(grid_of(anchors).best, vec(0.0, 1.0, 0.0), 0.866, TARGET, AXIS).r1
        for anchors in ([tuple(row) for row in PAPER], [tuple(row) for row in 2.0 * PAPER])
    ]
    assert 0.1 <= r1[1] < r1[0] < 0.15


def test_seen_from_ahead_the_target_is_in_view_and_from_aside_it_is_not():
    grid = grid_of([tuple(row) for row in PAPER])
    ahead = outlook(grid.best, vec(1.0, 1.0, 0.9), 0.866, TARGET, AXIS)
    aside = outlook(grid.best, vec(0.0, 1.2, 0.0), 0.866, TARGET, AXIS)
    assert ahead.in_view > 0.99
    assert aside.in_view < 0.01
    assert len(corners()) == 27
