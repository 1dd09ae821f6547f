from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from docking import Hand, perfect
from scipy.optimize import linprog, nnls

from missionkit.sim.free_flyer.body_model import FreeFlyerBody
from missionkit.sim.free_flyer.nozzle_allocation import (
    clipped_thrusts,
    least_thrusts,
    nozzle_matrix,
    thrusts_for,
    vertices,
)

BODY = FreeFlyerBody()
LIMITS = np.array([BODY.force] * 3 + [BODY.torque] * 3)
MATRIX = nozzle_matrix(BODY.size, BODY.nozzle_arm)
VERTICES = vertices(BODY.size, BODY.nozzle_arm)


def wrenches(count: int) -> np.ndarray:
    return np.random.default_rng(3).uniform(-1.0, 1.0, (count, 6)) * LIMITS


def test_ten_nozzles_push_and_turn_every_way():
    assert np.linalg.matrix_rank(MATRIX) == 6
    assert np.abs(MATRIX @ np.ones(10)).max() < 1e-15  # together nothing: so any wrench is positive
    assert np.abs(MATRIX[:3]).max(axis=0)[[0, 5]].tolist() == [1.0, 1.0]
    assert MATRIX[0, [1, 2, 3, 4, 6, 7, 8, 9]] == pytest.approx(0.0)  # along their face


def test_every_wrench_within_the_limits_is_exerted():
    corners = np.array(list(product((-1.0, 1.0), repeat=6))) * LIMITS
    for wrench in (*corners, *wrenches(200)):
        thrusts = thrusts_for(BODY, wrench[:3], wrench[3:])
        assert MATRIX @ thrusts == pytest.approx(wrench, abs=1e-12)
        assert thrusts.min() >= 0.0
        assert thrusts.max() <= BODY.nozzle_thrust + 1e-12


def test_the_linear_program_is_solved_to_its_optimum():
    for wrench in wrenches(60):
        solved = linprog(np.ones(10), A_eq=MATRIX, b_eq=wrench)
        assert least_thrusts(VERTICES, wrench).sum() == pytest.approx(solved.fun, rel=1e-9)


def test_the_ways_to_share_a_wrench_compared():
    """All exert it; the linear program takes least gas, the pseudo-inverse about 1.6 times that."""
    ratios, squares = [], []
    for wrench in wrenches(200):
        least = least_thrusts(VERTICES, wrench)
        lifted = clipped_thrusts(BODY.size, BODY.nozzle_arm, wrench)
        fitted, miss = nnls(MATRIX, wrench)
        assert MATRIX @ lifted == pytest.approx(wrench, abs=1e-12)
        assert lifted.min() >= -1e-15
        assert miss < 1e-9
        ratios.append(lifted.sum() / least.sum())
        squares.append(fitted.sum() / least.sum())
    assert min(ratios) >= 1.0 - 1e-9
    assert min(squares) >= 1.0 - 1e-9
    assert 1.4 < np.mean(ratios) < 1.9
    assert np.mean(squares) < np.mean(ratios)


def test_limits_clip_each_axis_and_weak_nozzles_keep_the_direction():
    thrusts = thrusts_for(BODY, np.array([9.0, -0.05, 0.0]), np.zeros(3))
    assert MATRIX @ thrusts == pytest.approx([0.1, -0.05, 0.0, 0.0, 0.0, 0.0], abs=1e-12)
    small = BODY.model_copy(update={"nozzle_thrust": 0.05})
    wrench = MATRIX @ thrusts_for(small, np.array([0.1, -0.02, 0.0]), np.zeros(3))
    assert wrench == pytest.approx([0.05, -0.01, 0.0, 0.0, 0.0, 0.0], abs=1e-12)


def test_less_than_a_pulse_is_saved_up():
    body = FreeFlyerBody(minimum_pulse=0.002, latency=0.0).model_dump()
    hand = Hand(perfect(vehicle=body))
    hand.arm()
    hand.push((0.001, 0.0, 0.0), (0.0, 0.0, 0.0), 4.0)  # 5 µN·s a step of a bit of 200
    assert hand.flyer.truth.velocity[0] == pytest.approx(0.004 / 1.33, abs=0.0002 / 1.33)
    speeds = np.unique(hand.flyer.track.rows[:, 4])
    assert len(speeds) == pytest.approx(20, abs=1)  # pulses
    assert np.diff(speeds).min() == pytest.approx(0.0002 / 1.33, rel=1e-6)


def test_the_pseudo_inverse_flies_as_well_and_takes_more_gas():
    used = {}
    for kind in ("linear_program", "pseudo_inverse"):
        body = FreeFlyerBody(allocation=kind, minimum_pulse=0.0, latency=0.0).model_dump()
        hand = Hand(perfect(vehicle=body))
        hand.arm()
        hand.push((0.02, 0.01, -0.02), (1e-4, 0.0, 2e-4), 2.0)
        used[kind] = (hand.flyer.gas, hand.flyer.truth.position.tolist())
    assert used["pseudo_inverse"][0] > 1.2 * used["linear_program"][0]
    assert used["pseudo_inverse"][1] == pytest.approx(used["linear_program"][1], abs=1e-12)
