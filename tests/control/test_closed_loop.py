"""The closed loop's matrix against the controller itself flying a vehicle that answers late."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from samples import calm

from missionkit.control.closed_loop import (
    AXES,
    gain_margin,
    loops,
    lyapunov,
    settling_time,
    slowest_pole,
)
from missionkit.control.controller import Control
from missionkit.control.disturbance_observer import DisturbanceObserver
from missionkit.control.pid import Gains
from missionkit.control.velocity_limits import Limits
from missionkit.messages import Guidance, Mode

FREE = dict.fromkeys(
    ("speed", "climb", "descent", "acceleration", "vertical_acceleration", "braking"), 1000000000.0
)
STEPS = 400
SUBSTEPS = 20  # of a period, in which the vehicle is integrated


def controller(kp: float, ki: float, kd: float, alpha: float, lag: float) -> Control:
    """Return a controller without limits, for which every axis is linear."""
    gains = Gains(kp=(kp, kp), ki=(ki, ki), kd=(kd, kd), integral_limit=1e9, zone=1e9)
    limits = Limits(**FREE, vertical_braking=1e9, lag=lag)
    return Control(gps=gains, alpha=alpha, limits=limits)


def flown(control: Control, axis: int, lags: tuple[float, float], rate: float) -> list[float]:
    """Return the distances (m) from the goal at each tick, integrated by small Euler steps."""
    memory, period = control.begin(), 1.0 / rate
    p, v, w = 1e-3, 0.0, 0.0
    far = []
    for tick in range(STEPS):
        position, velocity = np.zeros(3), np.zeros(3)
        position[axis], velocity[axis] = p, v
        seen = calm(now=tick * period, position=position, velocity=velocity)
        guidance = Guidance(np.zeros(3), 1e9, avoid=False)
        setpoint, memory = control.step(memory, Mode.GPS, guidance, seen, period)
        u, h = float(setpoint.velocity[axis]), period / SUBSTEPS
        for _ in range(SUBSTEPS):  # exact for each lag alone
            before = v
            w = u + (w - u) * math.exp(-h / lags[1])
            v = w + (v - w) * math.exp(-h / lags[0])
            p += 0.5 * h * (v + before)
        far.append(abs(p) + abs(v))
        if far[-1] > 1e6:
            break
    return far


@settings(deadline=None, derandomize=True, database=None, max_examples=25)
@given(
    st.floats(0.2, 30.0),
    st.floats(0.0, 40.0),
    st.floats(0.0, 3.0),
    st.floats(0.3, 1.0),
    st.floats(0.2, 1.5),
    st.sampled_from([5.0, 20.0, 50.0]),
    st.sampled_from([0, 1]),
)
def test_it_comes_to_rest_as_its_matrix_says(kp, ki, kd, alpha, lag, rate, which):
    control = controller(kp, ki, kd, alpha, lag)
    loop = loops(control, Mode.GPS, rate)[AXES[which]]
    size = abs(slowest_pole(loop.matrix()))
    assume(size < 0.96 or size > 1.04)
    lags = (loop.response.lag, loop.response.inner)
    far = flown(control, 2 * which, lags, rate)
    assert (max(far[len(far) // 2 :]) < max(far)) == (size < 1.0)
    assert (far[-1] < 1e-3) == (size < 1.0)
    assert (lyapunov(loop.matrix()) is not None) == (size < 1.0)


def test_lyapunov_falls_at_every_step():
    A = loops(Control(), Mode.VISUAL, 20.0)["level"].matrix()
    P = lyapunov(A)
    assert P is not None
    x = np.ones(len(A))
    for _ in range(100):
        following = A @ x
        fall = x @ P @ x - following @ P @ following
        assert fall == pytest.approx(x @ x, rel=1e-6)
        x = following


def test_an_observer_gives_the_lags():
    control = Control(observer=DisturbanceObserver(gain=(2.0, 4.0), lag=0.1))
    assert loops(control, Mode.GPS, 20.0)["vertical"].response == (0.25, 0.1)


def test_without_an_integral_it_has_no_state_for_it():
    gains = Gains(ki=(0.0, 0.0))
    loop = loops(Control(gps=gains), Mode.GPS, 20.0)["level"]
    assert loop.matrix().shape == (4, 4)
    assert loops(Control(gps=Gains(zone=0.0)), Mode.GPS, 20.0)["level"].ki == 0.0


def test_a_vehicle_without_lag():
    control = Control(
        limits=Limits(lag=0.0), alpha=1.0, gps=Gains(kp=(10, 10), ki=(0, 0), kd=(0, 0))
    )
    loop = loops(control, Mode.GPS, 20.0)["level"]
    assert abs(slowest_pole(loop.matrix())) == pytest.approx(0.5)  # 1 - kp h
    assert gain_margin(loop) == pytest.approx(4.0, rel=1e-3)  # 2/(kp h)


def test_the_margin_is_where_it_no_longer_comes_to_rest():
    loop = loops(Control(), Mode.VISUAL, 20.0)["level"]
    margin = gain_margin(loop)
    assert abs(slowest_pole(loop.matrix(margin))) == pytest.approx(1.0, abs=1e-4)
    assert gain_margin(loop._replace(kp=1e4)) == 0.0


def test_times():
    assert settling_time(0.5 + 0j, 0.05) == pytest.approx(0.05 / math.log(2))
    assert settling_time(0.1 + 0j, 0.05) == 0.05
    assert settling_time(1.0 + 0j, 0.05) == math.inf
