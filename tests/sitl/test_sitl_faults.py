from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missionkit.errors import UsageError
from missionkit.sitl.flight_modes import MODE_TABLES
from missionkit.sitl.wire_faults import BODY_FAULTS, WIRE, read_fault

Make = Callable[..., Any]
HEARTBEAT = mavlink.MAVLink_heartbeat_message(18, 8, 0, 0, 4, 3)
PX4 = MODE_TABLES["px4"]


def talking(station: Make, *faults: str) -> Any:
    px4 = station("px4", *faults)
    px4.send(HEARTBEAT)
    return px4


def stamps(px4: Any) -> np.ndarray:
    return np.array([message.time_usec for message in px4.all("HIGHRES_IMU")]) / 1e6


@pytest.mark.parametrize("fault", ["link_cut@1+2", "link_lost@1+2", "packets_lost=1@1+2"])
def test_nothing_comes_while_the_link_is_cut(station: Make, fault: str) -> None:
    px4 = talking(station, fault)
    px4.run(4.0)
    times = stamps(px4)
    assert not ((times > 1.02) & (times < 2.98)).any()
    assert (times < 1.0).sum() > 40
    assert (times > 3.0).sum() > 40


@pytest.mark.parametrize(("fault", "heard"), [("link_cut", False), ("link_lost", True)])
def test_only_a_cut_link_keeps_commands_away(station: Make, fault: str, heard: bool) -> None:
    px4 = talking(station, f"{fault}@0.5")
    px4.run(1.6)
    assert px4.command(400, 1) is None
    assert px4.state.armed is heard


def test_a_flapping_link_cuts_and_returns_repeatedly(station: Make) -> None:
    px4 = talking(station, "link_flapping=1@1")
    px4.run(5.0)
    gaps = np.diff(stamps(px4))
    assert (gaps > 0.45).sum() == 4
    assert gaps.max() < 0.55


def test_some_packets_are_lost(station: Make) -> None:
    px4 = talking(station, "packets_lost=0.3")
    for _ in range(5):
        px4.send(HEARTBEAT)
    px4.run(4.0)
    assert 0.6 < len(px4.all("HIGHRES_IMU")) / 200 < 0.8


def test_reordered_packets_are_late_not_lost(station: Make) -> None:
    px4 = talking(station, "packets_reordered=0.3@1")
    px4.run(4.0)
    times = stamps(px4)
    assert (np.diff(times) < 0).any()
    assert len(times) > 190


def test_delayed_packets_are_late(station: Make) -> None:
    px4 = talking(station, "packets_delayed=0.5@1")
    px4.run(3.0)
    assert stamps(px4)[-1] == pytest.approx(2.5, abs=0.03)


def test_acknowledgements_are_lost_but_commands_done(station: Make) -> None:
    px4 = talking(station, "acks_lost")
    px4.run(1.6)
    assert px4.command(400, 1) is None
    assert px4.state.armed


def test_acknowledgements_are_late(station: Make) -> None:
    px4 = talking(station, "acks_delayed=0.7")
    px4.run(1.6)
    assert px4.command(400, 1) is None
    px4.run(0.65)
    assert not px4.all("COMMAND_ACK")
    px4.run(0.1)
    assert px4.last("COMMAND_ACK").command == 400


def test_a_command_is_refused(station: Make) -> None:
    px4 = talking(station, "command_denied=22@1+3")
    px4.run(1.6)
    assert px4.command(400, 1) == 0
    assert px4.command(22, 0, 0, 0, 0, 0, 0, 491.0) == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
    px4.run(3.0)
    assert px4.command(22, 0, 0, 0, 0, 0, 0, 491.0) == 0


def test_the_pilot_takes_over_once(either: Any) -> None:
    either.take_off()
    name = "POSCTL" if either.px4 else "LOITER"
    fault = read_fault("pilot_mode", either.state.dialect)
    either.state.troubles.add(fault._replace(start=either.state.now + 1.0))
    either.run(1.5, either.velocity(2.0, 0.0, 0.0))
    assert either.state.mode.name == name
    either.run(0.7, either.velocity(2.0, 0.0, 0.0))
    assert either.last("HEARTBEAT").custom_mode == either.state.mode.number
    either.run(2.0, either.velocity(2.0, 0.0, 0.0))
    assert either.speed < 0.3  # setpoints move it no more
    assert either.mode("OFFBOARD" if either.px4 else "GUIDED") == 0
    either.run(0.5, either.velocity(2.0, 0.0, 0.0))
    assert either.state.mode.does.value == "commanded"


def test_a_restart_in_flight_forgets_rates_and_setpoints_and_holds(either: Any) -> None:
    either.take_off()
    either.command(511, mavlink.MAVLINK_MSG_ID_HIGHRES_IMU, 10_000)
    either.run(2.0, either.velocity(2.0, 0.0, 0.0))
    fault = read_fault("reboot=1.2", either.state.dialect)
    either.state.troubles.add(fault._replace(start=either.state.now))
    either.run(0.1)
    either.seen.clear()
    either.run(1.0, either.velocity(2.0, 0.0, 0.0))
    assert not either.seen
    either.run(1.5, either.velocity(2.0, 0.0, 0.0))
    assert either.state.armed
    assert either.state.mode.does.value == "hold"
    assert either.last("HEARTBEAT").custom_mode == either.state.mode.number
    imu = either.all("HIGHRES_IMU")
    assert not imu if not either.px4 else imu[-1].time_usec < 1.5e6
    assert len(imu) < 80
    either.run(2.0)
    assert either.speed < 0.2


def test_frozen_streams_repeat_old_values_but_the_heart_beats(station: Make) -> None:
    px4 = talking(station, "streams_frozen@2+2")
    px4.run(3.9)
    times = [message.time_boot_ms for message in px4.all("LOCAL_POSITION_NED")]
    assert times.count(times[-1]) > 50
    assert times[-1] <= 2000
    assert len(px4.all("HEARTBEAT")) == 4
    px4.run(0.5)
    assert px4.last("LOCAL_POSITION_NED").time_boot_ms > 4000


def test_stopped_streams_leave_heartbeats_and_answers(station: Make) -> None:
    px4 = talking(station, "streams_stopped@2")
    px4.run(2.05)
    px4.seen.clear()
    px4.run(2.0)
    assert {message.get_type() for message in px4.seen} == {"HEARTBEAT"}
    assert px4.command(400, 1) == 0


def test_lost_fixes_are_reported(station: Make) -> None:
    px4 = talking(station, "gnss_lost@2+2")
    px4.run(3.5)
    assert px4.last("GPS_RAW_INT").fix_type == mavlink.GPS_FIX_TYPE_NO_FIX
    px4.run(1.0)
    assert px4.last("GPS_RAW_INT").fix_type == mavlink.GPS_FIX_TYPE_3D_FIX


def test_a_failure_is_injected_over_the_wire(station: Make) -> None:
    px4 = talking(station)
    assert px4.command(420, 4, 1, 0) == mavlink.MAV_RESULT_DENIED
    px4.state.parameters.set("SYS_FAILURE_EN", 1)
    assert px4.command(420, 4, 1, 0) == 0
    px4.run(0.1)
    assert px4.state.gnss_lost
    assert px4.command(420, 4, 0, 0) == 0
    px4.run(0.1)
    assert not px4.state.gnss_lost


def test_a_sagging_battery_is_reported(station: Make) -> None:
    px4 = talking(station, "battery_sag=0.6@2")
    px4.run(4.0)
    assert px4.last("BATTERY_STATUS").battery_remaining == pytest.approx(40, abs=1)
    assert px4.last("SYS_STATUS").battery_remaining == pytest.approx(40, abs=1)


def test_faults_that_need_a_state_wait_for_it(station: Make) -> None:
    px4 = talking(station, "streams_stopped@visual:0.5")
    px4.run(3.0)
    px4.state.troubles.entered["visual"] = px4.state.now
    px4.run(0.6)
    px4.seen.clear()
    px4.run(1.0)
    assert {message.get_type() for message in px4.seen} == {"HEARTBEAT"}


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("link_cutt", "link_cut"),
        ("camera_off", "not a fault of the autopilot"),
        ("packets_lost=2", "range"),
        ("link_cut=3", "no value"),
        ("acks_delayed=soon", "number"),
        ("pilot_mode=LOITR", "LOITER"),
        ("link_cut@", "form"),
    ],
)
def test_mistakes_in_faults_are_reported(text: str, hint: str) -> None:
    with pytest.raises(UsageError, match=hint):
        read_fault(text, PX4)


@pytest.mark.parametrize("name", [*WIRE, *BODY_FAULTS])
def test_every_fault_can_be_named_alone(name: str) -> None:
    assert read_fault(name, PX4).name == name
