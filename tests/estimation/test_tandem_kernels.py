"""Kernels of the free flyer's filters against filterpy, numerical Jacobians and closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from filterpy.kalman import ExtendedKalmanFilter
from free_flights import ANCHORS, parameters
from scipy.stats import chi2

from missionkit.estimation.linear_algebra import joseph
from missionkit.estimation.tandem_ekf import initialization, state_layout
from missionkit.estimation.tandem_ekf.centre_of_mass import centre
from missionkit.estimation.tandem_ekf.feature_pattern import seen_in_world
from missionkit.estimation.tandem_ekf.measurement_models import (
    fuse_frame,
    fuse_range,
    lever_noise,
)
from missionkit.estimation.tandem_ekf.process_model import move, predict
from missionkit.estimation.tandem_ekf.state_layout import (
    ACCEPTED,
    GATE_1,
    GATE_3,
    GYRO_DENSITY,
    LEVER,
    NIS,
    OUTCOME,
    RANGE,
)
from missionkit.estimation.tandem_ekf.update import turn, update
from missionkit.geometry import conjugate, exp, log, multiply, normalised, skew

NOTHING = np.empty((0, 0))
PLACES = np.array(list(ANCHORS.values()), dtype=float)


@pytest.fixture
def rng():
    return np.random.default_rng(7)


def settings(**changes):
    return initialization.settings_of(parameters(**changes))


def a_state(rng):
    x = np.zeros(state_layout.STATE_WIDTH)
    x[:6] = 0.1 * rng.normal(size=6)
    x[6:10] = normalised(rng.normal(size=4))
    x[10:13] = 0.2 * rng.normal(size=3)
    return x


def interval(rng):
    return np.concatenate(([0.0], 0.1 * rng.normal(size=3), 0.3 * rng.normal(size=3), [0.0]))


def covariance(rng, n, scale=1e-2):
    A = scale * rng.normal(size=(n, n))
    return A @ A.T + 1e-6 * np.eye(n)


def off(x, e):
    """Return a state whose error is e (9,): δρ, δv, δθ in the mother-ship's axes."""
    y = x.copy()
    y[:6] += e[:6]
    y[6:10] = normalised(multiply(exp(e[6:9]), x[6:10]))
    return y


def less(y, x):
    return np.concatenate((y[:6] - x[:6], log(multiply(y[6:10], conjugate(x[6:10])))))


def numeric(function, x, n, h=1e-6):
    """Return the Jacobian of `function` over the error state by central differences."""
    steps = h * np.eye(9)[:n]
    return np.array([(function(off(x, e)) - function(off(x, -e))) / (2 * h) for e in steps]).T


def advanced(x, u, dt, s):
    y, j = x.copy(), np.empty((2, 3))
    move(y, u, dt, s, j)
    return y


def jacobian(x, u, dt, s):
    base = advanced(x, u, dt, s)
    return numeric(lambda y: less(advanced(y, u, dt, s), base), x, 9)


def noise(s, dt):
    Q, q = np.zeros((9, 9)), s[state_layout.ACCEL_DENSITY]
    Q[:3, :3], Q[3:6, 3:6] = q * dt**3 / 3 * np.eye(3), q * dt * np.eye(3)
    Q[:3, 3:6] = Q[3:6, :3] = q * dt**2 / 2 * np.eye(3)
    Q[6:, 6:] = s[GYRO_DENSITY] * dt * np.eye(3)
    return Q


def range_row(at, name, distance):
    return np.array([at, RANGE, distance, 0.0, 0.0, *ANCHORS[name], 0.0, 0.0])


def test_the_compound_prediction_is_f_p_f_transposed_plus_q(rng):
    s = settings()
    for _ in range(20):
        x, u, P, dt = a_state(rng), interval(rng), covariance(rng, 9), rng.uniform(0.001, 0.05)
        F = jacobian(x, u, dt, s)
        expected = F @ P @ F.T + noise(s, dt)
        predict(x, P, NOTHING, u, dt, s)
        np.testing.assert_allclose(P, expected, rtol=1e-6, atol=1e-11)


def test_the_tandem_prediction_is_never_surer_than_the_compound_one(rng):
    s = settings()
    for _ in range(20):
        x, u, dt = a_state(rng), interval(rng), 0.01
        P = np.zeros((9, 9))
        P[:6, :6], P[6:, 6:] = covariance(rng, 6), covariance(rng, 3)
        T, A = P[:6, :6].copy(), P[6:, 6:].copy()
        predict(x.copy(), P, NOTHING, u, dt, s)
        predict(x.copy(), T, A, u, dt, s)
        assert np.linalg.eigvalsh(T - P[:6, :6]).min() > -1e-12
        np.testing.assert_allclose(A, P[6:, 6:], rtol=1e-12)


def textbook(s, x, P):
    kf = ExtendedKalmanFilter(dim_x=6, dim_z=1)
    kf.x, kf.P, kf.R = x[:6, None].copy(), P.copy(), np.array([[s[state_layout.RANGE_VARIANCE]]])
    return kf


@pytest.mark.parametrize("compound", [False, True])
def test_without_attitude_every_step_is_filterpy_s(rng, compound):
    """Radio at the centre of mass and a perfect attitude: 6 states, 400 steps, 1e-9."""
    s = settings(radio=(0.0, 0.0, 0.0), gate=1.0 - 1e-12, gyro_noise=1e-12)
    x, dt = a_state(rng), 0.02
    P = np.diag([0.04] * 3 + [0.01] * 3)
    kf = textbook(s, x, P)
    kf.F[:3, 3:6], kf.Q = dt * np.eye(3), noise(s, dt)[:6, :6]
    A = np.zeros((3, 3))
    if compound:
        full, A = np.zeros((9, 9)), NOTHING
        full[:6, :6] = P
        P = full
    for n in range(400):
        place = PLACES[n % 4]
        z = np.linalg.norm(0.1 * np.sin(0.02 * n) - place) + 0.02 * rng.normal()
        predict(x, P, A, np.zeros(8), dt, s)
        row = np.array([x[state_layout.TIME], RANGE, z, 0.0, 0.0, *place, 0.0, 0.0])
        fuse_range(x, P, row, s)
        assert row[OUTCOME] == ACCEPTED
        kf.predict()

        def slope(y, at=place):
            d = y[:3, 0] - at
            return np.concatenate((d / np.linalg.norm(d), np.zeros(3)))[None]

        kf.update(
            np.array([[z]]), slope, lambda y, at=place: np.array([[np.linalg.norm(y[:3, 0] - at)]])
        )
        np.testing.assert_allclose(x[:6], kf.x[:, 0], rtol=1e-9, atol=1e-11)
        np.testing.assert_allclose(P[:6, :6], kf.P, rtol=1e-9, atol=1e-13)


def test_without_a_covariance_of_place_and_attitude_both_filters_answer_alike(rng):
    s = settings(underweight=0.2)
    for name in ANCHORS:
        x = a_state(rng)
        P = np.zeros((9, 9))
        P[:6, :6], P[6:, 6:] = covariance(rng, 6), covariance(rng, 3)
        T, A = P[:6, :6].copy(), P[6:, 6:].copy()
        z = np.linalg.norm(x[:3] - np.array(ANCHORS[name])) + 0.01
        one, two, a, b = range_row(0, name, z), range_row(0, name, z), x.copy(), x.copy()
        fuse_range(a, P, one, s)
        fuse_range(b, T, two, s)
        np.testing.assert_allclose(a, b, atol=1e-14)
        np.testing.assert_allclose(P[:6, :6], T, rtol=1e-12, atol=1e-18)
        np.testing.assert_allclose(P[6:, 6:], A, rtol=1e-12)
        assert one[NIS] == pytest.approx(two[NIS], rel=1e-12)


def test_a_correlated_attitude_is_corrected_by_a_range_in_the_compound_filter_alone(rng):
    s, x, P = settings(), a_state(rng), covariance(rng, 9, 0.03)
    row = range_row(0.0, "a", np.linalg.norm(x[:3] - PLACES[0]) + 0.02)
    before, q = P.copy(), x[6:10].copy()
    fuse_range(x, P, row, s)
    assert np.trace(P[6:, 6:]) < np.trace(before[6:, 6:])
    assert np.abs(x[6:10] - q).max() > 1e-6


def test_residuals_of_features_have_the_jacobian_that_is_used(rng):
    s, x = settings(), a_state(rng)
    rows = np.zeros((4, state_layout.ROW_WIDTH))
    rows[:, 2:5] = 0.5 * rng.normal(size=(4, 3))
    rows[:, 5:8] = x[:3] + 0.5 * rng.normal(size=(4, 3))
    r, y = seen_in_world(x, 0.0, rows, s)
    for n in range(4):
        J = numeric(lambda e, n=n: seen_in_world(e, 0.0, rows, s)[0][n], x, 9)
        arm = y[n] + r[n]
        np.testing.assert_allclose(J[:, :3], np.eye(3), atol=1e-7)
        np.testing.assert_allclose(J[:, 6:], -skew(arm), atol=1e-6)


@pytest.mark.parametrize("dof", [1, 3])
def test_the_gate_lets_9999_of_10000_good_measurements_through(dof):
    s = settings()
    gate = s[GATE_1 if dof == 1 else GATE_3]
    assert gate == pytest.approx(chi2.ppf(0.9999, dof), rel=1e-9)
    H, R = np.eye(dof, 6), np.eye(dof)
    for factor, passes in ((0.999, True), (1.001, False)):
        P, r = np.eye(6), np.zeros(dof)
        r[0] = math.sqrt(2.0 * gate * factor)  # S = 2 I
        _, nis, accepted = update(P, H, r, R, gate, s)
        assert accepted == passes
        assert nis == pytest.approx(gate * factor)
        assert (P[0, 0] == 1.0) != passes


@pytest.mark.parametrize("prior", [0.3, 3.0])
def test_underweighting_is_an_inflated_innovation_while_the_prior_is_large(prior):
    s = settings(underweight_above=1.0, underweight=0.2)
    P, H, R = np.diag([prior, 1.0, 1.0]), np.array([[1.0, 0.0, 0.0]]), np.eye(1)
    d, _, _ = update(P, H, np.array([1.0]), R, 1e9, s)
    S = (1.2 if prior > 1.0 else 1.0) * prior + 1.0
    assert d[0] == pytest.approx(prior / S)
    assert P[0, 0] == pytest.approx(prior - prior * prior / S)


def test_reset_carries_the_covariance_to_the_new_attitude(rng):
    """Errors about the old quaternion, seen from the new one, to the order d² that is left out."""
    x, d = a_state(rng), np.array([0.04, -0.08, 0.06])
    P = covariance(rng, 9)
    before, q = P.copy(), x[6:10].copy()
    turn(x, P, 6, d)
    np.testing.assert_allclose(x[6:10], normalised(multiply(exp(d), q)), atol=1e-15)

    def seen(e):
        return log(multiply(multiply(exp(d + e), q), conjugate(x[6:10])))

    G, steps = np.eye(9), 1e-6 * np.eye(3)
    G[6:, 6:] = np.array([(seen(e) - seen(-e)) / 2e-6 for e in steps]).T
    sd = np.outer(*[np.sqrt(np.diag(P))] * 2)
    assert np.abs((P - G @ before @ G.T) / sd).max() < 2.0 * d @ d
    wrong = G.copy()
    wrong[6:, 6:] = G[6:, 6:].T
    assert np.abs((P - wrong @ before @ wrong.T) / sd).max() > 4.0 * d @ d


def test_a_long_look_never_makes_the_place_surer_than_the_attitude_allows(rng):
    A, y, white = 1e-4 * np.eye(3), np.array([0.0, 0.0, -0.5]), 1e-7
    P = np.eye(6)
    H = np.zeros((3, 6))
    H[:, :3] = -np.eye(3)
    for _ in range(500):
        update(P, H, np.zeros(3), lever_noise(P, A, y, white), 1e9, settings())
    limit = 0.5 * 0.01
    lateral = math.sqrt(P[0, 0])
    assert limit * 0.5 < lateral < 2.0 * limit
    assert P[0, 0] + P[1, 1] + P[2, 2] >= 2.0 * limit**2 * 0.99
    assert P[2, 2] < 1e-8


def test_joseph_s_form_keeps_an_ill_conditioned_covariance_positive():
    P = np.diag([1e8, 1.0, 1e-8]) + 1e-9
    H, R = np.array([[1.0, 1.0, 1.0]]), np.array([[1e-10]])
    K = P @ H.T / (H @ P @ H.T + R)
    Q = P.copy()
    joseph(Q, K, H, R)
    assert np.linalg.eigvalsh(Q).min() >= -1e-12
    np.testing.assert_array_equal(Q, Q.T)
    assert np.abs(Q - (np.eye(3) - K @ H) @ P @ (np.eye(3) - K @ H).T - K @ R @ K.T).max() < 1e-6


def test_the_centre_of_mass_and_its_covariance(rng):
    s, x = settings(), a_state(rng)
    P, lever = covariance(rng, 9), s[LEVER : LEVER + 3].copy()
    y, C = centre(x, P, NOTHING, lever)
    J = np.vstack((numeric(lambda e: centre(e, P, NOTHING, lever)[0], x, 9), np.eye(9)[6:]))
    np.testing.assert_allclose(C[:6, :6], (J @ P @ J.T)[:6, :6], rtol=1e-6, atol=1e-12)
    assert not C[9:].any()
    assert len(y) == 6


def test_a_frame_with_half_of_its_points_wrong_is_refused_as_a_whole(rng):
    s, x = settings(camera=(0.0, 0.0, 0.0), radio=(0.0, 0.0, 0.0)), np.zeros(17)
    x[6] = 1.0
    rows = np.zeros((4, state_layout.ROW_WIDTH))
    rows[:, 5:8] = [[0.05, 0.0, 0.5], [-0.05, 0.0, 0.5], [0.0, 0.05, 0.5], [0.0, -0.05, 0.5]]
    rows[:, 2:5] = rows[:, 5:8]
    rows[2:, 2:5] += [[0.0, 0.05, 0.1], [0.1, 0.0, 0.0]]
    P, A = 1e-4 * np.eye(6), 1e-6 * np.eye(3)
    fuse_frame(x, P, A, rows, s)
    assert not rows[:, OUTCOME].any()
    np.testing.assert_array_equal(P, 1e-4 * np.eye(6))
