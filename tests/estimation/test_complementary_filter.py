"""The complementary filter finds level, north and the gyroscope's bias."""

from __future__ import annotations

import importlib.util
import math

import numpy as np
import pytest

from missionkit import jit
from missionkit.estimation.optical_flow import axis_filter, complementary_filter, flow_velocity
from missionkit.estimation.optical_flow.complementary_filter import carry, lean, steer
from missionkit.geometry import conjugate, from_euler, multiply, rotate, to_euler, vec

GAINS = np.array([0.5, 0.0625])
UP = vec(0.0, 0.0, -9.80665)


def test_tilt_heading_and_bias_are_found():
    true, off = from_euler(0.1, -0.2, 0.7), vec(0.01, -0.02, 0.015)
    q, bias = multiply(from_euler(0.2, 0.1, 0.4), true), np.zeros(3)
    force, field = rotate(conjugate(true), UP), rotate(conjugate(true), vec(0.5, 0.0, 0.86))
    for _ in range(8000):
        lean(q, bias, force, off, 0.01, GAINS)
        steer(q, bias, field, 0.0, 0.01, GAINS)
    assert abs(q @ true) > 1.0 - 1e-9
    assert bias == pytest.approx(off, abs=1e-5)


def test_it_closes_at_the_rate_of_its_gain():
    q, bias = from_euler(0.05, 0.0, 0.0), np.zeros(3)
    for _ in range(200):
        lean(q, bias, UP, np.zeros(3), 0.01, np.array([0.5, 0.0]))
    assert to_euler(q)[0] == pytest.approx(0.05 * math.exp(-1.0), rel=0.02)


def test_accelerations_other_than_gravity_do_not_tilt():
    q, bias = from_euler(0.0, 0.0, 0.0), np.zeros(3)
    lean(q, bias, vec(6.0, 0.0, -9.8), np.zeros(3), 1.0, GAINS)
    assert np.array_equal(q, [1.0, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("field", [np.zeros(3), np.full(3, np.nan)])
def test_a_field_without_direction_does_not_turn(field):
    q, bias = from_euler(0.0, 0.0, 0.3), np.zeros(3)
    before = q.copy()
    steer(q, bias, field, 0.0, 0.1, GAINS)
    assert np.array_equal(q, before)


def test_mean_acceleration_and_rates_over_intervals():
    q, bias, pull, rates = from_euler(0, 0, math.pi / 2), vec(0, 0, 0.1), np.empty(3), np.empty(3)
    imu = np.zeros((4, 8))
    imu[:, 0] = (0.01, 0.02, 0.03, 0.05)
    imu[:, 1:4], imu[:, 6] = vec(1.0, 0.0, -9.80665), 0.1
    assert carry(q, bias, imu, 0.0, np.zeros(2), pull, rates) == pytest.approx(0.05)
    assert pull == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert rates == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    assert carry(q, bias, imu[:0], 0.05, np.zeros(2), pull, rates) == 0.0
    assert pull == pytest.approx([0.0, 0.0, 0.0])


def plain(module, monkeypatch):
    """Load a module of kernels afresh with a `compiled` that does nothing."""
    monkeypatch.setattr(jit, "compiled", lambda function: function)
    spec = importlib.util.find_spec(module.__name__)
    fresh = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(fresh)
    return fresh


def test_without_numba_the_numbers_are_the_same(monkeypatch):
    rng = np.random.default_rng(0)
    attitude, axis, velocity = (
        plain(it, monkeypatch) for it in (complementary_filter, axis_filter, flow_velocity)
    )
    assert axis.run is not axis_filter.run
    imu = rng.normal(size=(20, 8))
    imu[:, 0], imu[:, 3] = 0.01 * np.arange(1, 21), -9.8
    us, zs, field = *rng.normal(size=(2, 50)), rng.normal(size=3)
    results = []
    for angles, axes, ground in (
        (complementary_filter, axis_filter, flow_velocity),
        (attitude, axis, velocity),
    ):
        q, bias, pull, rates, out = from_euler(0.1, 0.2, 0.3), *np.zeros((3, 3)), np.zeros(2)
        angles.carry(q, bias, imu, 0.0, GAINS, pull, rates)
        angles.steer(q, bias, field, 0.1, 0.1, GAINS)
        assert ground.over_ground(field[:2], rates, 2.0, q, 0.1, out)
        track = axes.run(np.zeros(2), np.eye(2), us, zs, 0.05, 0.01, 0.02)
        results.append(np.concatenate([q, bias, pull, rates, out, track.ravel()]))
    np.testing.assert_allclose(*results, rtol=1e-12, atol=1e-12)
