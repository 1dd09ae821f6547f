from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missionkit.geometry import yaw_of

Make = Callable[..., Any]
QUIET = True
DONE, REJECTED, FAILED = 0, 1, 4


def local(mask: int, *numbers: float, frame: int = 1) -> Any:
    padded = (*numbers, *(0.0,) * (11 - len(numbers)))
    return mavlink.MAVLink_set_position_target_local_ned_message(0, 1, 1, frame, mask, *padded)


def test_it_takes_off_flies_a_velocity_and_lands(either: Any) -> None:
    either.take_off(5.0)
    assert -either.truth.position[2] == pytest.approx(5.0, abs=0.4)
    either.run(4.0, either.velocity(2.0, -1.0, 0.0))
    assert either.truth.velocity.tolist() == pytest.approx([2.0, -1.0, 0.0], abs=0.15)
    assert either.command(21) == DONE
    either.until(lambda: not either.state.armed, 20)
    assert either.truth.on_ground
    assert not either.truth.crashed


def test_velocities_in_the_body_frame_turn_with_it(either: Any) -> None:
    either.take_off()
    either.run(4.0, either.velocity(0.0, 0.0, 0.0, yaw_rate=0.4))
    heading = yaw_of(either.truth.attitude)
    assert heading == pytest.approx(1.6, abs=0.2)
    either.run(4.0, either.velocity(1.5, 0.0, 0.0, frame=8))
    level = either.truth.velocity
    assert math.hypot(level[0], level[1]) == pytest.approx(1.5, abs=0.15)
    assert math.atan2(level[1], level[0]) == pytest.approx(heading, abs=0.15)


def test_it_goes_to_a_position_and_heading(either: Any) -> None:
    either.take_off()
    either.run(12.0, lambda: local(0x9F8, 6.0, -3.0, -4.0, *(0.0,) * 6, 1.0))
    assert either.truth.position.tolist() == pytest.approx([6.0, -3.0, -4.0], abs=0.2)
    assert yaw_of(either.truth.attitude) == pytest.approx(1.0, abs=0.1)
    assert either.speed < 0.1


def test_it_goes_to_a_place_on_the_earth(either: Any) -> None:
    either.take_off()
    spot = either.state.earth.spot(np.array([4.0, 5.0, 0.0]))
    where = (round(spot.latitude * 1e7), round(spot.longitude * 1e7), 6.0)
    either.run(
        12.0,
        lambda: mavlink.MAVLink_set_position_target_global_int_message(
            0, 1, 1, 6, 0x9F8, *where, 0, 0, 0, 0, 0, 0, 0, 0
        ),
    )
    assert either.truth.position.tolist() == pytest.approx([4.0, 5.0, -6.0], abs=0.2)


def test_an_acceleration_builds_up_speed(either: Any) -> None:
    either.take_off()
    before = float(either.truth.velocity[1])
    either.run(2.0, lambda: local(0xC3F, 0, 0, 0, 0, 0, 0, 0.0, 0.5, 0.0))
    assert either.truth.velocity[1] - before == pytest.approx(1.0, rel=0.3)


@pytest.mark.parametrize("rates", [False, True])
def test_it_leans_as_commanded(station: Make, rates: bool) -> None:
    px4 = station("px4")
    px4.take_off()
    pitch = -0.1
    q = (math.cos(pitch / 2), 0.0, math.sin(pitch / 2), 0.0)

    def lean() -> Any:
        if not rates:
            return mavlink.MAVLink_set_attitude_target_message(0, 1, 1, 7, q, 0, 0, 0, 1 / 2.2)
        rate = pitch if px4.state.now < start + 1.0 else 0.0
        return mavlink.MAVLink_set_attitude_target_message(
            0, 1, 1, 0x80, (1, 0, 0, 0), 0, rate, 0, 1 / 2.2
        )

    start = px4.state.now
    px4.run(2.5, lean)
    assert px4.truth.velocity[0] > 0.7
    w, _, y, _ = px4.truth.attitude
    assert 2 * math.atan2(y, w) == pytest.approx(pitch, abs=0.05)


def test_thrust_is_a_climb_rate_for_ardupilot(station: Make) -> None:
    copter = station("ardupilot")
    copter.take_off()
    copter.run(
        3.0,
        lambda: mavlink.MAVLink_set_attitude_target_message(0, 1, 1, 7, (1, 0, 0, 0), 0, 0, 0, 0.7),
    )
    assert -copter.truth.velocity[2] == pytest.approx(1.0, abs=0.2)


def test_ardupilot_takes_off_by_an_attitude_with_the_thrust_to_climb(station: Make) -> None:
    def thrust(share: float) -> Any:
        return lambda: mavlink.MAVLink_set_attitude_target_message(
            0, 1, 1, 7, (1, 0, 0, 0), 0, 0, 0, share
        )

    copter = station("ardupilot")
    copter.run(1.6)
    assert copter.mode("GUIDED") == DONE
    assert copter.command(400, 1) == DONE
    copter.run(1.0, thrust(0.5))
    assert copter.truth.on_ground
    copter.run(3.0, thrust(0.7))
    assert copter.truth.position[2] < -1.0


def test_offboard_needs_setpoints_first(station: Make) -> None:
    px4 = station("px4")
    px4.run(1.6)
    assert px4.command(400, 1) == DONE
    assert px4.mode("OFFBOARD") == REJECTED
    px4.run(0.5, px4.velocity(0, 0, 0))
    assert px4.mode("OFFBOARD") == DONE


def test_guided_needs_arming_before_take_off_and_take_off_before_setpoints(station: Make) -> None:
    copter = station("ardupilot")
    copter.run(1.6)
    assert copter.mode("GUIDED") == DONE
    assert copter.command(22, 0, 0, 0, 0, 0, 0, 3.0) == FAILED
    assert copter.command(400, 1) == DONE
    copter.run(2.0, copter.velocity(0, 0, -1))
    assert copter.truth.on_ground


@pytest.mark.parametrize(("name", "refusing"), [("px4", "RTL"), ("ardupilot", "BRAKE")])
def test_some_modes_refuse_arming(station: Make, name: str, refusing: str) -> None:
    vehicle = station(name)
    vehicle.run(1.6)
    assert vehicle.mode(refusing) == DONE
    assert vehicle.command(400, 1) == (REJECTED if vehicle.px4 else FAILED)
    assert refusing in vehicle.said[-1]
    assert not vehicle.state.armed


def test_it_disarms_in_the_air_only_by_force(either: Any) -> None:
    either.take_off()
    assert either.command(400, 0) != DONE
    assert either.state.armed
    assert either.command(400, 0, 21196) == DONE
    either.run(3.0)
    assert either.truth.crashed


def test_it_returns_home(either: Any) -> None:
    either.take_off()
    either.run(7.0, either.velocity(3.0, 2.0, 0.0))
    assert np.linalg.norm(either.truth.position[:2]) > 15.0
    assert either.command(20) == DONE
    either.until(lambda: not either.state.armed, 90)
    assert np.linalg.norm(either.truth.position[:2]) < 1.0
    assert max(-either.state.body.track.rows[:, 3]) > 12.0


def test_it_repositions(either: Any) -> None:
    either.take_off()
    spot = either.state.earth.spot(np.array([5.0, -4.0, -6.0]))
    where = (round(spot.latitude * 1e7), round(spot.longitude * 1e7), spot.height)
    either.send(mavlink.MAVLink_command_int_message(1, 1, 0, 192, 0, 0, -1, 1, 0, 0, *where))
    assert either.last("COMMAND_ACK").result == DONE
    assert either.state.mode.name == ("LOITER" if either.px4 else "GUIDED")
    either.run(12.0)
    assert either.truth.position.tolist() == pytest.approx([5.0, -4.0, -6.0], abs=0.6)


def test_px4_flies_circles(station: Make) -> None:
    px4 = station("px4")
    px4.take_off()
    spot = px4.state.earth.spot(np.array([4.0, 0.0, -5.0]))
    where = (round(spot.latitude * 1e7), round(spot.longitude * 1e7), spot.height)
    order = (1, 1, 0, mavlink.MAV_CMD_DO_ORBIT, 0, 0, 4.0, 2.0, 0, 0, *where)
    px4.send(mavlink.MAVLink_command_int_message(*order))
    assert px4.last("COMMAND_ACK").result == DONE
    px4.run(20.0)
    rows = px4.state.body.track.rows[-1000:]
    gaps = np.hypot(rows[:, 1] - 4.0, rows[:, 2])
    assert gaps.min() > 3.0
    assert gaps.max() < 5.0
    assert np.ptp(rows[:, 2]) > 7.0


def test_an_armed_vehicle_that_stays_down_disarms(either: Any) -> None:
    either.run(1.6)
    assert either.mode("POSCTL" if either.px4 else "LOITER") == DONE
    assert either.command(400, 1) == DONE
    took = either.until(lambda: not either.state.armed, 15)
    assert took == pytest.approx(10.0, abs=0.2)


def test_an_actuator_is_switched(either: Any) -> None:
    assert either.command(183, 9, 1900) == DONE
    assert either.state.payload == "servo9"
    assert either.command(183, 9, 1100) == DONE
    assert either.state.payload is None
