from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from missionkit.errors import VehicleError
from missionkit.geometry import IDENTITY, from_euler, norm, to_euler, vec
from missionkit.messages import Action, AttitudeSetpoint, Command, PositionSetpoint, Setpoint
from missionkit.sim.position_control import (
    CLIMB_SPEED,
    CRUISE_SPEED,
    YAW_RATE,
    velocity_for,
)
from missionkit.sim.world import World

Make = Callable[..., Any]


def test_a_position_setpoint_is_reached_and_held(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.rise()
    flight.wait(12.0, Command(PositionSetpoint(vec(6.0, -3.0, -4.0), 1.0)))
    truth = flight.vehicle.truth
    assert truth.position == pytest.approx([6.0, -3.0, -4.0], abs=0.1)
    assert to_euler(truth.attitude)[2] == pytest.approx(1.0, abs=0.05)
    assert norm(truth.velocity) < 0.1


def test_an_attitude_is_refused_by_name(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.rise()
    with pytest.raises(VehicleError, match="does not fly attitude setpoints: use missionkit sitl"):
        flight.vehicle.apply(Command(AttitudeSetpoint(IDENTITY, 0.5)))


def test_the_autopilot_flies_home_by_itself_and_lands(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.rise()
    flight.fly((3.0, 2.0, 0.0), 8.0)
    out = flight.vehicle.truth.position
    assert math.hypot(out[0], out[1]) > 20.0
    flight.act(Action.RETURN)
    heights = []
    for _ in range(60):
        flight.wait(1.0)
        heights.append(-flight.vehicle.truth.position[2])
    assert max(heights) == pytest.approx(15.0, abs=0.8)
    home = flight.vehicle.truth
    assert home.on_ground
    assert not home.armed
    assert math.hypot(home.position[0], home.position[1]) < 1.5
    assert flight.events == []


def test_a_setpoint_ends_the_way_home(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.rise()
    flight.act(Action.RETURN)
    flight.wait(0.5)
    flight.fly((0.0, 0.0, 0.0), 2.0)
    assert flight.vehicle.truth.mode == "offboard"
    assert norm(flight.vehicle.truth.velocity) < 0.3


def test_a_return_on_the_ground_is_refused(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.act(Action.RETURN)
    flight.wait(1.0)
    assert flight.events == ["return_refused"]


def test_far_away_is_flown_to_at_a_limited_speed() -> None:
    state = np.zeros(17)
    state[6:10] = from_euler(0.0, 0.0, -2.0)
    command = velocity_for(PositionSetpoint(vec(300.0, 400.0, 50.0), 1.0), state)
    assert command.velocity == pytest.approx([0.6 * CRUISE_SPEED, 0.8 * CRUISE_SPEED, CLIMB_SPEED])
    assert command.yaw_rate == YAW_RATE


def test_a_velocity_is_not_changed() -> None:
    setpoint = Setpoint(vec(1.0, 2.0, 3.0), 0.1)
    assert velocity_for(setpoint, np.zeros(17)) is setpoint


@pytest.mark.parametrize(
    "bad", [PositionSetpoint(vec(math.nan, 0, 0), 0.0), PositionSetpoint(vec(0, 0, 0), math.inf)]
)
def test_an_invalid_place_is_refused(bad: PositionSetpoint) -> None:
    with pytest.raises(VehicleError, match="not finite"):
        velocity_for(bad, np.zeros(17))
