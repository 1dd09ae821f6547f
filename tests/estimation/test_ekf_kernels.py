"""The kernels against finite differences, textbook formulas and filterpy."""

from __future__ import annotations

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from scipy.linalg import block_diag

from missionkit.estimation import linear_algebra
from missionkit.estimation.error_state_ekf import (
    measurement_models,
    process_model,
    replay,
    state_layout,
    update,
)
from missionkit.estimation.error_state_ekf.measurement_log import row
from missionkit.geometry import GRAVITY, conjugate, exp, log, multiply, normalised, skew, vec

TARGETS = 2
N = state_layout.D_LANDMARKS + 3 * TARGETS
OPEN = np.full(4, 1e9)
NOISE = np.square([0.02, 0.0015, 3e-4, 2e-5, 0.01, 2.0, 0.5])
KINDS = [
    state_layout.FIX,
    state_layout.FIX_VELOCITY,
    state_layout.HEIGHT,
    state_layout.HEADING,
    state_layout.SIGHT,
]


def some_state(rng):
    x = rng.normal(size=N + 1)
    x[6:10] = normalised(x[6:10])
    return x


def some_covariance(rng):
    A = rng.normal(size=(N, N))
    return 0.01 * (A @ A.T / N + 0.1 * np.eye(N))


def plus(x, d):
    """Add an error state to a state."""
    return np.concatenate([x[:6] + d[:6], multiply(x[6:10], exp(d[6:9])), x[10:] + d[9:]])


def minus(a, b):
    """Return the error state from b to a."""
    turn = log(multiply(conjugate(b[6:10]), a[6:10]))
    return np.concatenate([a[:6] - b[:6], turn, a[10:] - b[10:]])


def numeric(f, h=1e-6):
    """Central differences of f over the error state."""
    return np.column_stack([(f(h * e) - f(-h * e)) / (2 * h) for e in np.eye(N)])


def some_row(rng, kind):
    noise = np.eye(3) * 0.04
    if kind in {state_layout.FIX, state_layout.FIX_VELOCITY, state_layout.SIGHT}:
        noise = noise + 0.01 * np.ones((3, 3))
    return row(kind, 1.0, rng.normal(size=3), noise, index=1, extra=0.2)


def moved(x, u, dt):
    out = x.copy()
    process_model.move(out, u, dt)
    return out


def dense_transition(x, u, dt):
    F = np.eye(N)
    J = process_model.move(x.copy(), u, dt)
    F[0:3, 3:6] = dt * np.eye(3)
    F[0:3, 6:15] = 0.5 * dt**2 * J[:3]
    F[3:6, 6:15] = dt * J[:3]
    F[6:9, 6:15] = J[3:]
    return F


def innovation(x, z):
    H, r = np.zeros((3, N)), np.zeros(3)
    m = measurement_models.predict(x, z, H, r)
    return H[:m], r[:m]


@pytest.fixture
def rng():
    return np.random.default_rng(7)


@pytest.fixture
def interval(rng):
    return np.array([0.01, *rng.normal(size=3) * 5, *rng.normal(size=3), 0.0])


def test_jacobian_of_the_motion(rng, interval):
    x = some_state(rng)
    expected = numeric(lambda d: minus(moved(plus(x, d), interval, 0.01), moved(x, interval, 0.01)))
    np.testing.assert_allclose(dense_transition(x, interval, 0.01), expected, atol=2e-6)


def test_motion_is_that_of_a_falling_and_of_a_thrusting_body():
    x = np.zeros(16)
    x[6] = 1.0
    for _ in range(100):
        process_model.move(x, np.zeros(8), 0.01)
    np.testing.assert_allclose(x[:6], [0, 0, 0.5 * 9.80665, 0, 0, 9.80665], rtol=1e-12)
    x = np.zeros(16)
    x[6:10] = exp(vec(0, 0, np.pi / 2))
    u = np.array([0, 2.0, 0, -GRAVITY, 0, 0, 0, 0])
    for _ in range(100):
        process_model.move(x, u, 0.01)
    np.testing.assert_allclose(x[:6], [0, 1, 0, 0, 2, 0], atol=1e-9)  # forward is east


def test_covariance_follows_the_motion(rng, interval):
    x, P = some_state(rng), some_covariance(rng)
    F = dense_transition(x, interval, 0.01)
    Q = np.diag(
        np.concatenate([np.zeros(3), *(np.full(3, q) for q in NOISE[:4]), np.full(6, NOISE[4])])
    )
    expected = F @ P @ F.T + 0.01 * Q
    process_model.propagate(x, P, interval, 0.01, NOISE)
    np.testing.assert_allclose(P, expected, atol=1e-15)


def test_missing_samples_cost_certainty(rng, interval):
    interval[state_layout.GAP] = 0.2
    x, P = some_state(rng), np.zeros((N, N))
    process_model.propagate(x, P, interval, 0.1, NOISE)
    np.testing.assert_allclose(P.diagonal()[3:6], 0.1 * (NOISE[0] + 0.2 * NOISE[5]))
    np.testing.assert_allclose(P.diagonal()[6:9], 0.1 * (NOISE[1] + 0.2 * NOISE[6]))


@pytest.mark.parametrize("kind", KINDS)
def test_jacobians_of_the_measurements(rng, kind):
    x, z = some_state(rng), some_row(rng, kind)
    H, _ = innovation(x, z)
    expected = numeric(lambda d: -innovation(plus(x, d), z)[1])
    np.testing.assert_allclose(H, expected, atol=1e-7)


@pytest.mark.parametrize("kind", KINDS)
def test_update_is_the_textbook_one(rng, kind):
    x, P, z = some_state(rng), some_covariance(rng), some_row(rng, kind)
    H, r = innovation(x, z)
    m = len(r)
    R = z[state_layout.NOISE : state_layout.EXTRA].reshape(3, 3)[:m, :m]
    S = H @ P @ H.T + R
    K = P @ H.T @ np.linalg.inv(S)
    d = K @ r
    reset = block_diag(np.eye(6), np.eye(3) - 0.5 * skew(d[6:9]), np.eye(N - 9))
    wanted_P = reset @ (np.eye(N) - K @ H) @ P @ reset.T
    wanted_x = plus(x, d)
    update.update(x, P, z, OPEN)
    np.testing.assert_allclose(x, wanted_x, atol=1e-12)
    np.testing.assert_allclose(P, wanted_P, atol=1e-12)
    assert z[state_layout.NIS] == pytest.approx(r @ np.linalg.solve(S, r))
    assert z[state_layout.OUTCOME] == state_layout.ACCEPTED


def test_agrees_with_filterpy_where_all_is_linear():
    """At rest, without biases or tilt: height and climb rate are a linear filter of two states."""
    q, dt, sd = 0.02**2, 0.01, 0.3
    peer = KalmanFilter(dim_x=2, dim_z=1)
    peer.F, peer.H = np.array([[1, dt], [0, 1]]), np.array([[-1.0, 0.0]])
    peer.P, peer.Q, peer.R = np.diag([4.0, 1.0]), np.diag([0, q * dt]), np.array([[sd**2]])
    x, P = np.zeros(16), np.zeros((15, 15))
    x[6], P[2, 2], P[5, 5] = 1.0, 4.0, 1.0
    u = np.array([dt, 0, 0, -GRAVITY, 0, 0, 0, 0])
    for k in range(50):
        peer.predict()
        peer.update(np.array([[0.1 * k]]))
        process_model.propagate(x, P, u, dt, np.array([q, 0, 0, 0, 0, 0, 0]))
        update.update(
            x, P, row(state_layout.HEIGHT, 0.0, vec(0.1 * k, 0, 0), sd**2 * np.eye(3)), OPEN
        )
    np.testing.assert_allclose([x[2], x[5]], peer.x.ravel(), atol=1e-12)
    np.testing.assert_allclose(P[np.ix_([2, 5], [2, 5])], peer.P, atol=1e-12)


@pytest.mark.parametrize("smallest", [1e-14, 1e-10, 1e-6])
def test_ill_conditioned_covariances_stay_positive(rng, smallest, interval):
    """Directions up to fourteen orders apart, and sensors far better than the prior."""
    x = some_state(rng)
    A, _ = np.linalg.qr(rng.normal(size=(N, N)))
    P = A @ np.diag(np.geomspace(smallest, 1.0, N)) @ A.T
    for kind in KINDS * 3:
        z = some_row(rng, kind)
        z[state_layout.NOISE : state_layout.EXTRA] *= 1e-8
        update.update(x, P, z, np.full(4, np.inf))
        assert z[state_layout.OUTCOME] == state_layout.ACCEPTED
        np.testing.assert_array_equal(P, P.T)
        assert np.linalg.eigvalsh(P).min() >= -1e-14 * np.linalg.eigvalsh(P).max()
    assert P.diagonal().min() > 0.0


def test_the_gate_refuses_and_changes_nothing(rng):
    x, P, z = some_state(rng), some_covariance(rng), some_row(rng, state_layout.FIX)
    z[state_layout.Z] += 100.0
    x0, P0 = x.copy(), P.copy()
    update.update(x, P, z, np.array([0.0, 15.1, 18.4, 21.1]))
    assert z[state_layout.OUTCOME] == state_layout.REJECTED
    np.testing.assert_array_equal(x, x0)
    np.testing.assert_array_equal(P, P0)


def test_an_innovation_without_variance_is_refused(rng):
    x, z = some_state(rng), row(state_layout.FIX, 0.0, vec(0, 0, 0), np.zeros((3, 3)))
    update.update(x, np.zeros((N, N)), z, OPEN)
    assert z[state_layout.OUTCOME] == state_layout.REJECTED


@pytest.mark.parametrize(("velocity_sd", "shift", "relative"), [(0.0, 9.0, 1.998), (5.0, 0.0, 1.0)])
def test_forgetting_takes_seen_targets_along_unless_the_velocity_was_wrong(
    velocity_sd, shift, relative
):
    """Target 0 was seen from the vehicle, target 1 never."""
    P = np.eye(N)
    P[0:3, 15:18] = P[15:18, 0:3] = 0.001 * np.eye(3)
    x = np.zeros(N + 1)
    x[6] = 1.0
    forget = row(
        state_layout.FORGET_VEHICLE, 0.0, vec(velocity_sd, 0.1, 0.2), np.zeros(3), extra=100.0
    )
    replay.take(x, P, forget, OPEN)
    assert P[3, 3] == max(velocity_sd**2, 1.0)
    assert P[6, 6] == pytest.approx(1.01 if velocity_sd else 1.0)
    assert P[9, 9] == pytest.approx(1.04 if velocity_sd else 1.0)
    replay.take(x, P, row(state_layout.FIX, 0.0, vec(9, 0, 0), np.full(3, 1e-6)), OPEN)
    np.testing.assert_allclose(x[16:22], [shift, 0, 0, 0, 0, 0], atol=2e-3)
    assert P[0, 0] + P[15, 15] - 2 * P[0, 15] == pytest.approx(relative, abs=2e-3)


def test_forgetting_a_target_puts_it_where_it_is_seen(rng):
    x, P = some_state(rng), some_covariance(rng)
    z = vec(4.0, 1.0, -1.0)
    replay.take(x, P, row(state_layout.FORGET_TARGET, 0.0, z, np.zeros(3), 1, extra=4.0), OPEN)
    np.testing.assert_allclose(
        innovation(x, row(state_layout.SIGHT, 0.0, z, np.ones(3), 1))[1], 0, atol=1e-12
    )
    np.testing.assert_array_equal(P[18:21, 18:21], 16.0 * np.eye(3))
    np.testing.assert_array_equal(P[18:21, :18], 0.0)


def test_inverse(rng):
    A = some_covariance(rng)
    inverse, positive = linear_algebra.inverted(A)
    assert positive
    np.testing.assert_allclose(inverse @ A, np.eye(N), atol=1e-9)
    assert not linear_algebra.inverted(-A)[1]


@pytest.mark.parametrize(
    "spoil",
    [
        lambda s: s.__setitem__(2, np.nan),
        lambda s: s.__setitem__(3, 1e9),
        lambda s: s.__setitem__(0, 0.01),
    ],
)
def test_unusable_samples_leave_a_gap(spoil):
    samples = np.zeros((3, 7))
    samples[:, 0], samples[:, 1] = [0.01, 0.02, 0.03], [1.0, 2.0, 3.0]
    spoil(samples[1])
    last = np.zeros(7)
    out = process_model.intervals(samples, last, 0.015)
    np.testing.assert_allclose(out[:, 0], [0.01, 0.03])
    np.testing.assert_allclose(out[:, 1], [0.5, 2.0])
    np.testing.assert_allclose(out[:, state_layout.GAP], [0.0, 0.02])
    assert last[0] == 0.03
