"""The filter of one axis against filterpy, closed forms and bad input."""

from __future__ import annotations

import math

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter

from missionkit.estimation.optical_flow import filterpy_axis
from missionkit.estimation.optical_flow.axis_filter import (
    AXIS_POSITION,
    AXIS_VELOCITY,
    predict,
    run,
    settled,
    update,
)

DT, VARIANCE, NOISE = 0.05, 0.007868, 0.006017
PRINTED = [(0.007868, 0.006017), (0.00871, 0.00995)]


def textbook(dt, variance, noise, part):
    """P2's matrices, as filterpy wants them."""
    kf = KalmanFilter(dim_x=2, dim_z=1, dim_u=1)
    kf.F = np.array([[1.0, dt], [0.0, 1.0]])
    kf.B = np.array([[0.5 * dt * dt], [dt]])
    kf.H = np.eye(2)[part : part + 1]
    kf.Q = kf.B @ kf.B.T * variance
    kf.R = np.array([[noise]])
    return kf


@pytest.mark.parametrize(("variance", "noise"), PRINTED)
@pytest.mark.parametrize("part", [AXIS_POSITION, AXIS_VELOCITY])
def test_every_step_is_filterpy_s(rng, variance, noise, part):
    kf = textbook(DT, variance, noise, part)
    kf.x, kf.P = np.array([[1.0], [-0.3]]), np.array([[0.2, 0.05], [0.05, 0.4]])
    mu, S = kf.x[:, 0].copy(), kf.P.copy()
    for step in range(400):
        u, z = rng.normal(size=2)
        kf.predict(u=np.array([[u]]))
        assert predict(mu, S, u, DT, variance)
        if step % 7:  # every seventh sample is missing
            kf.update(z)
            assert update(mu, S, z, noise, part)
        np.testing.assert_allclose(mu, kf.x[:, 0], rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(S, kf.P, rtol=1e-9, atol=1e-12)


def test_a_whole_flight_is_its_steps(rng):
    us, zs = rng.normal(size=(2, 300))
    zs[40:60] = np.nan
    out = run(np.zeros(2), np.eye(2), us, zs, DT, VARIANCE, NOISE)
    mu, S = np.zeros(2), np.eye(2)
    for n in range(300):
        predict(mu, S, us[n], DT, VARIANCE)
        if not 40 <= n < 60:
            update(mu, S, zs[n], NOISE, AXIS_VELOCITY)
        assert np.array_equal(out[n], mu)


@pytest.mark.parametrize(("variance", "noise"), PRINTED)
def test_it_settles_where_the_riccati_equation_says(variance, noise):
    mu, S = np.zeros(2), np.zeros((2, 2))
    run(mu, S, np.zeros(4000), np.zeros(4000), DT, variance, noise)
    predict(mu, S, 0.0, DT, variance)
    assert S[1, 1] == pytest.approx(settled(variance, noise, DT), rel=1e-9)


@pytest.mark.parametrize(("variance", "noise"), PRINTED)
def test_the_position_s_variance_grows_by_the_flow_s_noise_alone(variance, noise):
    S = np.zeros((2, 2))
    run(np.zeros(2), S, np.zeros(6000), np.zeros(6000), DT, variance, noise)
    assert S[0, 0] == pytest.approx(noise * DT * 300.0, rel=0.01)


@pytest.mark.parametrize(("variance", "noise"), PRINTED)
def test_a_constant_error_of_acceleration_moves_the_position_no_further(variance, noise):
    out = run(
        np.zeros(2), np.zeros((2, 2)), np.full(9000, 0.1), np.zeros(9000), DT, variance, noise
    )
    assert out[2000, 0] > 0.05
    assert out[-1, 0] == pytest.approx(out[2000, 0], rel=1e-6)
    k = settled(variance, noise, DT)
    k /= k + noise
    assert out[-1, 1] == pytest.approx(0.1 * DT * (1.0 - k) / k, rel=1e-6)  # its velocity stays off


def test_spread_over_flights_is_what_the_filter_claims(rng):
    ends, S = [], np.zeros((2, 2))
    for _ in range(400):
        us = math.sqrt(VARIANCE) * rng.normal(size=1200)
        zs = math.sqrt(NOISE) * rng.normal(size=1200)
        S = np.zeros((2, 2))
        ends.append(run(np.zeros(2), S, us, zs, DT, VARIANCE, NOISE)[-1])
    np.testing.assert_allclose(np.std(ends, axis=0), np.sqrt(np.diag(S)), rtol=0.1)


def test_without_measurements_the_variance_grows_as_free_motion():
    mu, S = np.array([2.0, 0.5]), np.diag([0.01, 0.04])
    run(mu, S, np.zeros(20), np.full(20, np.nan), DT, 0.0, NOISE)
    np.testing.assert_allclose(mu, [2.5, 0.5])
    np.testing.assert_allclose(S, [[0.01 + 0.04, 0.04], [0.04, 0.04]])


@pytest.mark.parametrize("noise", [1e-14, 1e-6, 1e12])
@pytest.mark.parametrize("start", [np.zeros((2, 2)), 1e12 * np.eye(2), np.full((2, 2), 1e6)])
def test_ill_conditioned_input_leaves_a_covariance(rng, start, noise):
    mu, S = np.zeros(2), start.copy()
    for step in range(300):
        predict(mu, S, rng.normal(), DT, VARIANCE)
        update(mu, S, rng.normal(), noise, step % 2)
        assert np.isfinite(mu).all()
        assert np.isfinite(S).all()
        assert S[0, 1] == S[1, 0]
        assert min(S[0, 0], S[1, 1]) >= 0.0
        assert S[0, 1] ** 2 <= S[0, 0] * S[1, 1] * (1 + 1e-6) + 1e-20


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e9])
def test_what_is_not_a_number_changes_nothing(bad):
    mu, S = np.array([1.0, 2.0]), np.array([[0.3, 0.1], [0.1, 0.2]])
    before = mu.copy(), S.copy()
    assert not predict(mu, S, bad, DT, VARIANCE)
    assert not predict(mu, S, 0.0, bad, VARIANCE)
    assert not update(mu, S, bad, NOISE, AXIS_VELOCITY)
    assert np.array_equal(mu, before[0])
    assert np.array_equal(S, before[1])


@pytest.mark.parametrize("noise", [math.nan, math.inf, -0.1])
def test_an_invalid_variance_changes_nothing(noise):
    mu, S = np.array([1.0, 2.0]), np.eye(2)
    assert not update(mu, S, 0.0, noise, AXIS_VELOCITY)
    assert not predict(mu, S, 0.0, -DT, VARIANCE)
    assert np.array_equal(mu, [1.0, 2.0])
    assert np.array_equal(S, np.eye(2))


def test_certainty_cannot_be_corrected_by_certainty():
    mu, S = np.array([1.0, 2.0]), np.zeros((2, 2))
    assert not update(mu, S, 0.0, 0.0, AXIS_VELOCITY)
    assert np.array_equal(mu, [1.0, 2.0])


@pytest.fixture
def rng():
    return np.random.default_rng(5)


@pytest.mark.parametrize("part", [AXIS_POSITION, AXIS_VELOCITY])
def test_the_choice_of_filterpy_is_the_kernels_to_the_last_digits(rng, part):
    mu, S = np.array([1.0, -0.3]), np.array([[0.2, 0.05], [0.05, 0.4]])
    theirs, P = mu.copy(), S.copy()
    for _ in range(300):
        u, z = rng.normal(size=2)
        assert predict(mu, S, u, DT, VARIANCE)
        assert filterpy_axis.predict(theirs, P, u, DT, VARIANCE)
        assert update(mu, S, z, NOISE, part)
        assert filterpy_axis.update(theirs, P, z, NOISE, part)
        np.testing.assert_allclose(theirs, mu, rtol=0.0, atol=1e-12)
        np.testing.assert_allclose(P, S, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e7])
def test_filterpy_never_gets_nan_or_infinity(bad):
    mu, S = np.array([1.0, -0.3]), np.eye(2)
    assert not filterpy_axis.predict(mu, S, bad, DT, VARIANCE)
    assert not filterpy_axis.predict(mu, S, 0.0, -DT, VARIANCE)
    assert not filterpy_axis.update(mu, S, bad, NOISE, AXIS_VELOCITY)
    assert not filterpy_axis.update(mu, S, 0.0, -NOISE, AXIS_VELOCITY)
    assert mu.tolist() == [1.0, -0.3]
    assert S.tolist() == np.eye(2).tolist()


def test_what_filterpy_makes_of_a_broken_covariance_does_not_count():
    mu, S = np.array([1.0, -0.3]), np.array([[math.nan, 0.0], [0.0, 1.0]])
    assert not filterpy_axis.update(mu, S, 0.0, NOISE, AXIS_VELOCITY)
    assert mu.tolist() == [1.0, -0.3]
