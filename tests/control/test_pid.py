from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from missionkit.control import pid
from missionkit.control.pid import Gains, PidMemory, Tracking
from missionkit.control.velocity_limits import Limits

LIMITS = Limits()
small = st.floats(-0.4, 0.4)


def test_is_the_textbook_pid_near_the_goal():
    """At rest, against Kp e + Ki ∫e + Kd ė summed by numpy."""
    gains = Gains(kp=(0.7, 0.9), ki=(0.2, 0.3), kd=(0.1, 0.2), integral_limit=5.0)
    errors = np.random.default_rng(1).uniform(-0.4, 0.4, (50, 3))
    memory, dt = PidMemory(), 0.05
    got = []
    for e in errors:
        track = Tracking(tuple(e), (0.0, 0.0, 0.0), 10.0)
        u, memory = pid.step(gains, LIMITS, memory, track, dt)
        got.append(u)
    before = np.vstack([np.zeros(3), np.cumsum(errors, axis=0)[:-1]]) * dt
    expected = errors * (0.7, 0.7, 0.9) + before * (0.2, 0.2, 0.3)
    np.testing.assert_allclose(got, expected, atol=1e-12)


def test_derivative_acts_on_velocity():
    gains = Gains(kd=(0.1, 0.2))
    zero = (0.0, 0.0, 0.0)
    u, _ = pid.step(gains, LIMITS, PidMemory(), Tracking(zero, (1.0, -2.0, 3.0), 10.0), 0.05)
    assert u == pytest.approx((0.1, -0.2, 0.6))


def test_the_intended_approach_charges_nothing():
    gains, memory, dt = Gains(), PidMemory(), 0.001
    k = gains.kp[0]
    for t in np.arange(0.0, 8.0, dt):
        e = 0.9 * np.exp(-k * t)
        track = Tracking((e, 0.0, 0.0), (-k * e, 0.0, 0.0), 5.0)
        _, memory = pid.step(gains, LIMITS, memory, track, dt)
    assert abs(memory.integral[0]) < 1e-9


def test_saturated_output_does_not_integrate_except_towards_zero():
    gains = Gains()
    stuck = Tracking((0.5, 0.0, 0.0), (0.0, 0.0, 0.0), 0.1)
    _, memory = pid.step(gains, LIMITS, PidMemory(), stuck, 0.05)
    assert memory.integral == (0.0, 0.0, 0.0)
    _, memory = pid.step(gains, LIMITS, PidMemory((-0.5, 0.0, 0.0)), stuck, 0.05)
    assert -0.5 < memory.integral[0] < 0.0


def test_integrates_only_within_its_zone_and_not_while_blocked():
    gains = Gains(zone=1.0)
    zero = (0.0, 0.0, 0.0)
    for track in (Tracking((1.1, 0, 0), zero, 9.0), Tracking((0.5, 0, 0), zero, 9.0, blocked=True)):
        assert pid.step(gains, LIMITS, PidMemory(), track, 0.05)[1].integral == zero


@given(small, small, small, st.integers(1, 400))
def test_integral_is_bounded(x, y, z, steps):
    gains, memory = Gains(integral_limit=0.3), PidMemory()
    for _ in range(steps):
        track = Tracking((x, y, z), (0.0, 0.0, 0.0), 9.0)
        u, memory = pid.step(gains, LIMITS, memory, track, 0.2)
    assert max(map(abs, memory.integral)) <= 0.3
    assert np.isfinite(u).all()
