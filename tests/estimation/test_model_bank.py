"""Banks of models: kernels against filterpy, textbook truths, and a true robot."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.estimation.target_tracking import model_bank, multiple_models
from missionkit.estimation.target_tracking.multiple_models import (
    Bank,
    BankState,
    bank,
    begun,
    corrected,
    kernels,
    predicted,
)
from missionkit.ground_robot import GroundRobot
from missionkit.messages.robot_modes import SPIN, STRAIGHT
from missionkit.sim.ground_robots import SPIN_LEFT, advance, placed, random_offsets

ROBOT = GroundRobot()
DT, SD = 0.05, 0.0135  # s; m: 1.5 px at 2.5 m
R = SD**2 * np.eye(2)
ESTIMATORS = ("imm", "mmae", "static")
NUMBA = kernels("numba")


def drive(seed: int, seconds: float, phase: float):
    """The truth (n, 3) of one robot, how long it still spins (n,), and measured places (n, 2)."""
    rng = np.random.default_rng(seed)
    robots = placed(np.zeros((1, 2)), np.array([0.5]), np.array([phase]), ROBOT, obstacles=0)
    offsets = random_offsets(rng, 1, seconds, ROBOT)
    rows = []
    for _ in range(round(seconds / DT)):
        advance(robots, offsets, ROBOT, DT)
        rows.append(robots[0].copy())
    truth = np.array(rows)
    return truth[:, :3], truth[:, SPIN_LEFT], truth[:, :2] + rng.normal(0.0, SD, (len(rows), 2))


def start(models: Bank, heading: float = 0.6) -> BankState:
    return begun(models, np.array([0.0, 0.0, heading]), np.diag([SD**2, SD**2, 0.3**2]))


def track(models: Bank, places, library=NUMBA) -> list[BankState]:
    known, states = start(models), []
    for z in places:
        known = corrected(models, predicted(models, known, DT, library), z, R, library)
        states.append(known)
    return states


@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_kernels_are_filterpy_to_the_last_digits(estimator):
    models = bank(estimator, ROBOT)
    places = drive(1, 6.0, phase=2.0)[2]
    ours, theirs = track(models, places), track(models, places, kernels("filterpy"))
    for mine, other in zip(ours, theirs, strict=True):
        for a, b in zip(mine, other, strict=True):
            np.testing.assert_allclose(a, b, atol=1e-9)


@pytest.mark.parametrize("library", ["numba", "filterpy"])
@pytest.mark.parametrize("estimator", ESTIMATORS)
@pytest.mark.parametrize(
    ("z", "noise"),
    [
        (np.array([math.nan, 0.0]), R),
        (np.array([0.0, math.inf]), R),
        (np.array([1e300, 0.0]), R),
        (np.zeros(2), np.full((2, 2), math.nan)),
        (np.zeros(2), -R),
        (np.zeros(2), np.zeros((2, 2))),
        (np.zeros(2), np.array([[1.0, 2.0], [2.0, 1.0]])),
        (np.zeros(2), np.diag([math.inf, 1.0])),
    ],
)
def test_what_is_no_measurement_changes_nothing(estimator, library, z, noise):
    models = bank(estimator, ROBOT)
    known = start(models)
    assert corrected(models, known, z, noise, kernels(library)) is known


def test_probabilities_are_bayes_rule():
    models = bank("imm", ROBOT)
    known = predicted(models, start(models), DT, NUMBA)
    z = np.array([0.02, 0.01])
    densities = []
    for x, P in zip(known.X, known.P, strict=True):
        S = P[:2, :2] + R
        r = z - x[:2]
        at = math.exp(-0.5 * r @ np.linalg.solve(S, r)) / (2 * math.pi * np.linalg.det(S) ** 0.5)
        densities.append(at)
    wanted = known.mu * densities / (known.mu @ densities)  # P4 (21), with the Pr(x_2) it lacks
    assert corrected(models, known, z, R, NUMBA).mu == pytest.approx(wanted, abs=1e-9)


def test_mmae_keeps_its_probabilities_within_their_limits():
    models = bank("mmae", ROBOT)
    mus = np.array([known.mu for known in track(models, drive(2, 20.0, phase=6.0)[2])])
    assert mus.min() >= 0.01 * (1.0 - 1e-12)
    assert mus.max() <= 0.99 * (1.0 + 1e-12)
    assert mus.sum(axis=1) == pytest.approx(1.0)


def test_a_measurement_that_no_model_explains_leaves_finite_probabilities():
    models = bank("imm", ROBOT)
    known = corrected(models, start(models), np.array([900.0, 900.0]), R, NUMBA)
    assert np.isfinite(known.mu).all()
    assert known.mu.sum() == pytest.approx(1.0)


def test_switching_is_a_markov_chain_and_steps_add_up():
    rates = bank("imm", ROBOT).rates
    M = model_bank.switching(rates, 0.05)
    assert M.sum(axis=1) == pytest.approx(1.0)
    assert M[0, 1] == pytest.approx(0.05 / 20.0, rel=0.01)
    assert M[1, 0] == pytest.approx(0.05 / ROBOT.spin_time, rel=0.02)
    still = model_bank.switching(np.zeros((3, 3)), 1.0)
    np.testing.assert_array_equal(still, np.eye(3))


@pytest.mark.parametrize("turn", [0.0, 2.0, 3.1, -3.1])
def test_a_bank_does_not_care_where_the_circle_begins(turn):
    models = bank("imm", ROBOT)
    c, s = math.cos(turn), math.sin(turn)
    places = drive(3, 10.0, phase=4.0)[2]
    turned = places @ np.array([[c, s], [-s, c]])
    known = begun(models, np.array([0.0, 0.0, 0.6 + turn + 2.0 * math.pi]), start(models).P[0])
    for z in turned:
        known = corrected(models, predicted(models, known, DT, NUMBA), z, R, NUMBA)
    plain = track(models, places)[-1]
    assert known.mu == pytest.approx(plain.mu, abs=1e-6)
    x, _ = model_bank.combined(*known)
    y, _ = model_bank.combined(*plain)
    assert math.cos(x[2] - y[2] - turn) == pytest.approx(1.0, abs=1e-9)


def test_the_mean_heading_is_that_of_the_circle():
    X = np.array([[0.0, 0.0, 3.1], [0.0, 0.0, -3.1]])
    x, P = model_bank.combined(X, np.tile(1e-6 * np.eye(3), (2, 1, 1)), np.array([0.5, 0.5]))
    assert abs(x[2]) == pytest.approx(math.pi)
    assert P[2, 2] == pytest.approx((math.pi - 3.1) ** 2, rel=1e-3)


def test_imm_sees_a_spin_and_knows_the_heading_after_it_but_mmae_does_not():
    """Eight robots; P4's straight filter still has the heading of before when it is over."""
    errors = {"imm": [], "mmae": []}
    for seed in range(8):
        truth, spinning, places = drive(seed, 13.0, phase=8.0)
        begin, end = np.flatnonzero(spinning > 0.0)[[0, -1]]
        for name, found in errors.items():
            models = bank(name, ROBOT)
            states = track(models, places)
            spin = np.array([known.mu[models.names.index(SPIN)] for known in states])
            if name == "imm":
                assert (spin[begin + 7 : end - 1] > 0.5).all()  # 0.35 s
                assert (spin[40 : begin - 1] > 0.5).mean() < 0.02
            x, _ = model_bank.combined(*states[end + 10])  # 0.5 s after it
            off = x[2] - truth[end + 10, 2]
            found.append(abs(math.degrees(math.atan2(math.sin(off), math.cos(off)))))
    assert max(errors["imm"]) < 20.0
    assert np.median(errors["mmae"]) > 60.0


def test_the_likeliest_model_of_a_driving_robot_is_straight():
    models = bank("imm", ROBOT)
    known = track(models, drive(4, 8.0, phase=19.0)[2])[-1]
    assert models.names[int(np.argmax(known.mu))] == STRAIGHT
    assert multiple_models.begun(models, known.X[0], known.P[0]).mu.sum() == pytest.approx(1.0)
