from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from missionkit.control.yaw_law import Regime, YawLaw, YawMemory

LAW = YawLaw()


def desired(distance, memory=None, velocity=(0.0, 3.0), target=None):
    memory = YawMemory() if memory is None else memory
    return LAW.desired(memory, (-distance, 0.0), velocity, yaw=0.4, target=target)


@pytest.mark.parametrize(
    ("distance", "regime", "yaw"),
    [
        (61.0, Regime.COURSE, math.pi / 2),
        (60.0, Regime.BEARING, math.pi),
        (1.6, Regime.BEARING, math.pi),
        (1.5, Regime.TARGET, -1.0),
    ],
)
def test_the_three_rules(distance, regime, yaw):
    got, memory = desired(distance, target=-1.0)
    assert memory.regime is regime
    assert abs(got) == pytest.approx(abs(yaw))


def test_course_is_held_below_the_minimum_speed():
    got, memory = desired(80.0, velocity=(0.0, 0.1))
    assert got == 0.4
    _, memory = desired(80.0, memory, velocity=(0.0, 3.0))
    got, _ = desired(80.0, memory, velocity=(0.05, -0.1))
    assert got == pytest.approx(math.pi / 2)


def test_without_a_target_yaw_the_near_field_keeps_the_bearing():
    _, memory = desired(5.0)
    got, _ = desired(0.3, memory)
    assert abs(got) == pytest.approx(math.pi)


@pytest.mark.parametrize("edge", [LAW.far, LAW.near])
def test_noise_at_an_edge_changes_the_regime_once(edge):
    noise = np.random.default_rng(3).uniform(-0.1, 0.1, 200)
    memory, regimes = YawMemory(), []
    for factor in np.linspace(1.3, 0.8, 200) + noise:
        _, memory = desired(float(edge * factor), memory)
        regimes.append(memory.regime)
    assert sum(a is not b for a, b in pairwise(regimes)) == 1


def test_leaving_needs_the_band():
    _, memory = desired(50.0)
    _, memory = desired(74.0, memory)
    assert memory.regime is Regime.BEARING
    _, memory = desired(76.0, memory)
    assert memory.regime is Regime.COURSE


@given(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0))
def test_rate_turns_the_shorter_way_and_is_limited(goal, yaw):
    rate = LAW.rate(goal, yaw)
    assert abs(rate) <= math.radians(LAW.max_rate_deg) + 1e-12
    before = 1.0 - math.cos(goal - yaw)
    after = 1.0 - math.cos(goal - (yaw + 0.05 * rate))
    assert after <= before + 1e-12
