from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import integrate

from missionkit.control.velocity_limits import (
    Limits,
    approach_speed,
    finite,
    within,
)
from missionkit.geometry import vec
from missionkit.messages import Setpoint

reals = st.floats(-100.0, 100.0)
triples = st.tuples(reals, reals, reals)


@given(triples)
def test_bounded_keeps_the_horizontal_direction(velocity):
    limits = Limits(speed=4.0, climb=2.0, descent=1.0)
    x, y, z = limits.bounded(velocity)
    assert math.hypot(x, y) <= 4.0 + 1e-9
    assert -2.0 <= z <= 1.0
    assert x * velocity[1] == pytest.approx(y * velocity[0], abs=1e-6)


@given(triples, triples, st.floats(0.0, 0.2))
def test_slewed_is_within_reach_and_between(last, wanted, dt):
    limits = Limits()
    got = limits.slewed(last, wanted, dt)
    assert math.dist(got[:2], last[:2]) <= limits.acceleration * dt + 1e-9
    assert abs(got[2] - last[2]) <= limits.vertical_acceleration * dt + 1e-9
    assert math.dist(got, wanted) <= math.dist(last, wanted) + 1e-9


@given(triples, st.floats(0.0, 50.0))
def test_within_shortens_only_what_is_too_long(velocity, top):
    short, cut = within(velocity, top)
    assert math.hypot(*short) <= top + 1e-9
    assert cut or short == velocity
    assert not cut or math.hypot(*velocity) > top - 1e-9


def test_approach_never_exceeds_its_deceleration():
    """Fly v(d) exactly: v' = v dv/dd must stay above -braking and reach the goal."""
    gain, braking = 0.9, 1.5
    distance = np.linspace(0.0, 60.0, 20001)
    speed = np.array([approach_speed(d, gain, braking) for d in distance])
    deceleration = speed * np.gradient(speed, distance)
    assert deceleration.max() <= braking * 1.001
    assert (np.diff(speed) > 0.0).all()
    flown = integrate.solve_ivp(
        lambda t, d: [-approach_speed(max(d[0], 0.0), gain, braking)], (0.0, 25.0), [60.0]
    )
    assert 0.0 <= flown.y[0, -1] < 0.1


def test_finite_passes_only_numbers():
    good = Setpoint(vec(1, 2, 3), 0.1)
    assert finite(good) is good
    assert finite(Setpoint(vec(1, math.nan, 3), 0.1)) is None
    assert finite(Setpoint(vec(1, 2, 3), math.inf)) is None
