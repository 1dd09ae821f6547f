from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from missionkit.geometry import to_euler, wrap
from missionkit.messages import Action, Command
from missionkit.sim.inner_autopilot import mix
from missionkit.sim.kernel_layout import Body, LoopGains, constants
from missionkit.sim.rigid_body import advance
from missionkit.sim.vehicle_parameters import BatteryModel, InnerAutopilotModel
from missionkit.sim.world import Wind, World

Make = Callable[..., Any]


def test_tilt_steps_within_a_third_of_a_second_without_ringing() -> None:
    body: Body
    gains: LoopGains
    body, _, gains, _, _ = constants(World(world="test"))
    state, u, work = np.zeros(17), np.zeros(4), np.empty((5, 17))
    state[6], state[13:17] = 1.0, body.mass * 9.80665 / 4
    push = np.array([9.80665 * np.tan(np.radians(20)), 0.0, 0.0])
    pitches = []
    for _ in range(200):
        mix(state, push, 0.0, body, gains, u)
        advance(state, u, np.zeros(3), body, 0.005, work)
        pitches.append(-np.degrees(to_euler(state[6:10])[1]))
    assert next(n for n, p in enumerate(pitches) if p > 18.0) * 0.005 < 0.4
    assert max(pitches) < 22.0
    assert pitches[-1] == pytest.approx(20.0, abs=0.3)


def test_take_off_reaches_the_height_and_holds(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.rise(4.0)
    truth = flight.vehicle.truth
    assert truth.mode == "hold"
    assert truth.position == pytest.approx([0.0, 0.0, -4.0], abs=0.1)
    assert np.linalg.norm(truth.velocity) < 0.05


def test_velocity_setpoint_is_reached_in_wind(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect.model_copy(update={"wind": Wind(mean=(-4.0, 3.0, 0.0))}))
    flight.rise()
    flight.fly((3.0, -1.0, -0.5), 6.0)
    truth = flight.vehicle.truth
    assert truth.mode == "offboard"
    assert truth.velocity == pytest.approx([3.0, -1.0, -0.5], abs=0.1)
    peak = flight.vehicle.track.rows[-120:, 4].max()
    assert peak < 3.4


def test_yaw_rate_setpoint_turns_clockwise(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.rise()
    before = to_euler(flight.vehicle.truth.attitude)[2]
    flight.fly((0.0, 0.0, 0.0), 4.0, spin=0.5)
    turned = wrap(to_euler(flight.vehicle.truth.attitude)[2] - before)
    assert turned == pytest.approx(2.0, abs=0.1)


def test_silence_turns_offboard_into_hold_within_its_patience(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.rise()
    flight.fly((5.0, 0.0, 0.0), 4.0)
    flight.wait(0.45)
    assert flight.vehicle.truth.mode == "offboard"
    flight.wait(0.2)
    assert flight.vehicle.truth.mode == "hold"
    flight.wait(8.0)
    stopped = flight.vehicle.truth.position
    flight.wait(5.0)
    assert np.linalg.norm(flight.vehicle.truth.velocity) < 0.02
    assert np.linalg.norm(flight.vehicle.truth.position - stopped) < 0.05


def test_empty_command_ends_offboard_at_once_but_not_a_take_off(
    perfect: World, pilot: Make
) -> None:
    flight = pilot(perfect)
    flight.wait(1.2)
    flight.act(Action.ARM)
    flight.act(Action.TAKE_OFF, 5.0)
    flight.wait(1.0, Command())
    assert flight.vehicle.truth.mode == "take_off"
    flight.fly((1.0, 0.0, 0.0), 1.0)
    assert flight.vehicle.truth.mode == "offboard"
    flight.wait(0.15, Command())
    assert flight.vehicle.truth.mode == "hold"


def test_landing_is_gentle_and_disarms(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.rise(3.0)
    flight.act(Action.LAND)
    flight.wait(12.0)
    truth, rows = flight.vehicle.truth, flight.vehicle.track.rows
    assert truth.on_ground
    assert not truth.armed
    assert not truth.crashed
    sinking = rows[(rows[:, 3] > -0.3) & (rows[:, 14] == 0.0), 6]
    assert sinking.max() < 0.5
    landed = rows[(rows[:, 14] == 1.0) & (rows[:, 0] > 5.0)]
    assert landed[landed[:, 15] == 1.0][:, 0].size * 0.05 == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("early", [Action.TAKE_OFF, Action.LAND, Action.HOLD])
def test_unarmed_vehicle_refuses_to_move(perfect: World, pilot: Make, early: Action) -> None:
    flight = pilot(perfect)
    flight.wait(1.2)
    flight.act(early)
    flight.wait(2.0)
    assert flight.events == [f"{early}_refused"]
    assert flight.vehicle.truth.on_ground


def test_arming_is_refused_on_a_low_battery(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect.model_copy(update={"battery": BatteryModel(charge=0.1)}))
    flight.wait(1.2)
    flight.act(Action.ARM)
    assert flight.events == ["arm_refused"]
    assert not flight.seen[-1].status or not flight.seen[-1].status.ready


def test_disarming_in_the_air_is_refused(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.rise()
    flight.act(Action.DISARM)
    assert flight.events == ["disarm_refused"]
    assert flight.vehicle.truth.armed


def test_empty_battery_falls(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect, "battery_sag=1@10")
    flight.rise(5.0)
    flight.wait(5.0)
    assert flight.vehicle.truth.crashed


def test_commands_take_twenty_to_forty_milliseconds(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.wait(1.2)
    flight.vehicle.apply(Command(action=Action.ARM))
    flight.vehicle.advance(1.2 + 0.015)
    assert not flight.vehicle.truth.armed
    flight.vehicle.advance(1.2 + 0.045)
    assert flight.vehicle.truth.armed


def test_own_velocity_error_has_its_spread_and_drifts_without_gnss(
    perfect: World, pilot: Make
) -> None:
    world = perfect.model_copy(update={"autopilot": InnerAutopilotModel()})
    flight = pilot(world)
    flight.rise()
    flight.fly((0.0, 0.0, 0.0), 300.0)
    steady = flight.vehicle.track.rows[-6000:, 4:6].std()
    assert steady == pytest.approx(0.05, rel=0.3)
    lost = pilot(world, "gnss_lost@10")
    lost.rise(6.0)
    lost.fly((0.0, 0.0, 0.0), 300.0)
    assert lost.vehicle.track.rows[-2000:, 4:6].std() > 2 * steady
