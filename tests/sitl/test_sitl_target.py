from __future__ import annotations

import math

import numpy as np
import pytest
from sitl_station import EXACT

from missionkit.geometry import GRAVITY, from_euler, yaw_of
from missionkit.sitl.setpoint_tracking import (
    SetpointTarget,
    TrackingLimits,
    follow,
    turned,
)
from missionkit.sitl.simulated_body import SimulatedBody

LIMITS = TrackingLimits(gain=0.95, gain_up=1.0, speed=12.0, up=3.0, down=1.5, hover=0.5)


@pytest.fixture
def body() -> SimulatedBody:
    return SimulatedBody(EXACT, 0)


def test_a_position_draws_in_proportion(body: SimulatedBody) -> None:
    found = follow(SetpointTarget(0.0, position=(2.0, -1.0, -1.5)), body, LIMITS)
    assert found.velocity.tolist() == pytest.approx([1.9, -0.95, -1.5])


def test_speeds_are_limited(body: SimulatedBody) -> None:
    far = follow(SetpointTarget(0.0, position=(300.0, -400.0, -50.0), speed=5.0), body, LIMITS)
    assert far.velocity.tolist() == pytest.approx([3.0, -4.0, -3.0])
    fast = follow(SetpointTarget(0.0, velocity=(30.0, 0.0, 9.0)), body, LIMITS)
    assert fast.velocity.tolist() == pytest.approx([12.0, 0.0, 1.5])


def test_a_velocity_is_fed_forward_to_a_position(body: SimulatedBody) -> None:
    target = SetpointTarget(0.0, position=(1.0, 0.0, 0.0), velocity=(2.0, None, None))
    assert follow(target, body, LIMITS).velocity[0] == pytest.approx(2.95)


def test_an_acceleration_is_what_the_inner_loop_makes_of_it(body: SimulatedBody) -> None:
    found = follow(SetpointTarget(0.0, acceleration=(0.0, 1.1, 0.4)), body, LIMITS)
    assert found.velocity.tolist() == pytest.approx([0.0, 1.1 / 2.2, 0.4 / 4.0])


def test_a_level_attitude_with_hover_thrust_changes_nothing(body: SimulatedBody) -> None:
    level = SetpointTarget(0.0, attitude=from_euler(0.0, 0.0, 0.0), thrust=0.5)
    assert np.abs(follow(level, body, LIMITS).velocity).max() < 1e-9


def test_leaning_forward_accelerates_forward(body: SimulatedBody) -> None:
    pitch = math.radians(-10.0)
    lean = SetpointTarget(0.0, attitude=from_euler(0.0, pitch, 0.0), thrust=0.5 / math.cos(pitch))
    found = follow(lean, body, LIMITS).velocity * (2.2, 2.2, 4.0)
    assert found.tolist() == pytest.approx([GRAVITY * math.tan(-pitch), 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize(("yaw", "rate"), [(0.3, 0.6), (-0.2, -0.4), (3.0, 1.5), (-3.0, -1.5)])
def test_it_turns_the_short_way_and_not_too_fast(
    body: SimulatedBody, yaw: float, rate: float
) -> None:
    assert follow(SetpointTarget(0.0, yaw=yaw), body, LIMITS).yaw_rate == pytest.approx(rate)


def test_rates_turn_an_attitude() -> None:
    target = SetpointTarget(
        0.0, attitude=from_euler(0.0, 0.0, 0.2), rates=np.array([0.0, 0.0, 0.5])
    )
    after = turned(target, 0.4).attitude
    assert after is not None
    assert yaw_of(after) == pytest.approx(0.4)
