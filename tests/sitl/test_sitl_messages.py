from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missionkit.sim.world import Cylinder, World
from missionkit.sitl.stream_scheduler import DEFAULT_RATES, MESSAGE_BUILDERS
from missionkit.sitl.wire_faults import read_fault

Make = Callable[..., Any]
HEARTBEAT = mavlink.MAVLink_heartbeat_message(18, 8, 0, 0, 4, 3)


def test_a_heartbeat_names_the_autopilot(either: Any) -> None:
    either.run(2.05)
    beats = either.all("HEARTBEAT")
    assert len(beats) == 3
    assert {beat.autopilot for beat in beats} == {12 if either.px4 else 3}
    assert {(beat.type, beat.get_srcComponent()) for beat in beats} == {(2, 1)}


def test_only_heartbeats_go_to_a_silent_port(station: Make) -> None:
    px4 = station("px4")
    px4.run(1.0)
    assert {message.get_type() for message in px4.seen} == {"HEARTBEAT"}
    px4.send(HEARTBEAT)
    px4.run(3.0)
    assert {message.get_msgId() for message in px4.seen} == set(DEFAULT_RATES["px4"])


def test_ardupilot_sends_nothing_unless_requested(station: Make) -> None:
    copter = station("ardupilot")
    copter.send(HEARTBEAT)
    copter.run(2.0)
    by_itself = {"HEARTBEAT", "OBSTACLE_DISTANCE"}
    assert {message.get_type() for message in copter.seen} == by_itself
    copter.send(mavlink.MAVLink_request_data_stream_message(1, 1, 6, 5, 1))
    copter.run(1.0)
    assert len(copter.all("GLOBAL_POSITION_INT")) == pytest.approx(5, abs=1)


def test_px4_does_not_know_the_old_groups_of_streams(station: Make) -> None:
    px4 = station("px4")
    px4.send(mavlink.MAVLink_request_data_stream_message(1, 1, 0, 1, 1))
    px4.run(2.0)
    assert len(px4.all("ATTITUDE")) == pytest.approx(100, abs=1)


def test_every_message_is_read_back_by_pymavlink(either: Any) -> None:
    either.take_off()
    for number in MESSAGE_BUILDERS:
        either.command(512, number)
    either.run(1.0, either.velocity(1, 0, 0))
    kinds = {message.get_type() for message in either.seen}
    assert not [kind for kind in kinds if kind.startswith("UNKNOWN") or kind == "BAD_DATA"]
    assert len(kinds) >= len(MESSAGE_BUILDERS) - 7  # here are no ground robots to tell of
    for message in either.seen:
        again = either._mav.parse_buffer(message.get_msgbuf())
        assert [m.to_dict() for m in again] == [message.to_dict()] or "nan" in str(message)


def test_packets_are_numbered_without_gaps(station: Make) -> None:
    px4 = station("px4")
    px4.send(HEARTBEAT)
    px4.run(2.0)
    numbers = [message.get_seq() for message in px4.seen]
    assert numbers == [n % 256 for n in range(len(numbers))]


def test_rates_are_as_requested(station: Make) -> None:
    px4 = station("px4")
    assert px4.command(511, mavlink.MAVLINK_MSG_ID_HIGHRES_IMU, 10_000) == 0
    assert px4.command(511, mavlink.MAVLINK_MSG_ID_ATTITUDE, -1) == 0
    px4.run(1.0)
    px4.seen.clear()
    px4.run(2.0)
    assert len(px4.all("HIGHRES_IMU")) == 200
    assert len({message.time_usec for message in px4.all("HIGHRES_IMU")}) == 200
    assert not px4.all("ATTITUDE")
    assert px4.command(510, mavlink.MAVLINK_MSG_ID_HIGHRES_IMU) == 0
    assert px4.last("MESSAGE_INTERVAL").interval_us == 10_000
    assert px4.command(511, 9999, 10_000) != 0


def test_an_inertial_sample_says_which_sensors_are_new(station: Make) -> None:
    px4 = station("px4")
    px4.send(HEARTBEAT)
    px4.run(2.0)
    flags = [
        message.fields_updated for message in px4.all("HIGHRES_IMU") if message.time_usec > 1e6
    ]
    assert all(flag & 0x3F == 0x3F for flag in flags)
    assert sum(bool(flag & 0x1C0) for flag in flags) == pytest.approx(10, abs=1)
    assert sum(bool(flag & 0x800) for flag in flags) == pytest.approx(10, abs=1)


def test_the_estimator_reports_a_lost_position(either: Any) -> None:
    number, kind = (230, "ESTIMATOR_STATUS") if either.px4 else (193, "EKF_STATUS_REPORT")
    either.run(1.5)
    assert either.command(512, number) == 0
    assert either.last(kind).flags & 16  # EKF_POS_HORIZ_ABS
    either.state.troubles.add(read_fault("gnss_lost@2", either.state.dialect))
    either.run(12.0)
    assert either.command(512, number) == 0
    assert not either.last(kind).flags & 16


def test_a_fix_is_sent_once_however_often_it_is_requested(either: Any) -> None:
    assert either.command(511, mavlink.MAVLINK_MSG_ID_GPS_RAW_INT, 20_000) == 0
    either.run(3.0)
    times = [message.time_usec for message in either.all("GPS_RAW_INT") if message.fix_type == 3]
    assert len(times) == len(set(times)) == pytest.approx(14, abs=1)


def test_telemetry_matches_ground_truth(either: Any) -> None:
    either.take_off()
    for number in (32, 33, 31, 105 if either.px4 else 27, 24):
        either.command(511, number, 20_000)
    either.run(4.0, either.velocity(2.0, -1.0, 0.0))
    true = either.truth
    local = either.last("LOCAL_POSITION_NED")
    assert [local.x, local.y, local.z] == pytest.approx(true.position.tolist(), abs=1e-3)
    assert [local.vx, local.vy, local.vz] == pytest.approx(true.velocity.tolist(), abs=1e-3)
    turned = either.last("ATTITUDE_QUATERNION")
    assert [turned.q1, turned.q2, turned.q3, turned.q4] == pytest.approx(true.attitude, abs=1e-3)
    there = either.last("GLOBAL_POSITION_INT")
    radius = 6_371_000.0 if either.px4 else 6_378_100.0
    north = math.radians(there.lat / 1e7 - 47.397742) * radius
    assert north == pytest.approx(true.position[0], abs=0.05)
    assert there.relative_alt / 1e3 == pytest.approx(-true.position[2], abs=0.01)
    name, unit = ("HIGHRES_IMU", 1.0) if either.px4 else ("RAW_IMU", 9.80665e-3)
    imu = either.last(name)
    assert unit * imu.zacc == pytest.approx(-9.8, abs=0.8)
    assert imu.time_usec == pytest.approx(1e6 * true.at, abs=1)
    fix = either.last("GPS_RAW_INT")
    assert (fix.fix_type, fix.vel_acc) == (3, 80)
    assert fix.vel / 100.0 == pytest.approx(math.hypot(2.0, 1.0), abs=0.4)


def test_a_scan_shows_obstacles_where_they_are(station: Make) -> None:
    pole = Cylinder(use="cylinder", at=(0.0, 6.0), radius=1.0, height=9.0)
    px4 = station("px4", world=World(world="pole", obstacles=(pole,)))
    px4.send(HEARTBEAT)
    px4.run(1.0)
    scan = px4.last("OBSTACLE_DISTANCE")
    assert len(scan.distances) == 72
    assert scan.increment == 5
    assert int(np.argmin(scan.distances)) == 18  # 90 degrees: east
    assert min(scan.distances) == pytest.approx(500, abs=15)
    assert scan.distances[54] == scan.max_distance + 1


def test_an_acknowledgement_goes_to_the_sender(station: Make) -> None:
    px4 = station("px4", who=(42, 191))
    assert px4.command(512, 148) == 0
    ack = px4.last("COMMAND_ACK")
    assert (ack.target_system, ack.target_component) == (42, 191)
    assert px4.last("AUTOPILOT_VERSION").capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2


def test_unknown_commands_are_answered_as_unsupported(either: Any) -> None:
    assert either.command(31999) == mavlink.MAV_RESULT_UNSUPPORTED


def test_messages_for_other_systems_are_ignored(either: Any) -> None:
    either.send(mavlink.MAVLink_command_long_message(7, 1, 512, 0, 148, 0, 0, 0, 0, 0, 0))
    assert not either.all("COMMAND_ACK")


def test_ping_and_timesync_are_answered(either: Any) -> None:
    either.run(0.5)
    either.send(mavlink.MAVLink_ping_message(77, 3, 0, 0))
    assert (either.last("PING").time_usec, either.last("PING").seq) == (77, 3)
    either.send(mavlink.MAVLink_timesync_message(0, 12345))
    answer = either.last("TIMESYNC")
    assert (answer.ts1, answer.tc1) == (12345, 500_000_000)


def test_it_is_armable_only_once_it_has_a_position(either: Any) -> None:
    prearm = mavlink.MAV_SYS_STATUS_PREARM_CHECK
    either.command(511, 1, 100_000)
    either.run(0.5)
    assert not either.last("SYS_STATUS").onboard_control_sensors_health & prearm
    either.run(1.5)
    assert either.last("SYS_STATUS").onboard_control_sensors_health & prearm


def test_the_version_is_answered_by_message_and_by_both_commands(either: Any) -> None:
    either.send(mavlink.MAVLink_autopilot_version_request_message(1, 1))
    assert either.command(520, 1) == 0  # REQUEST_AUTOPILOT_CAPABILITIES
    assert either.command(512, 148) == 0  # REQUEST_MESSAGE
    answers = either.all("AUTOPILOT_VERSION")
    assert len(answers) == 3
    assert len({(it.capabilities, it.flight_sw_version) for it in answers}) == 1


def test_ardupilots_fence_is_healthy_unless_breached_also_where_there_is_none(
    station: Make,
) -> None:
    copter, bit = station("ardupilot"), mavlink.MAV_SYS_STATUS_GEOFENCE

    def said() -> tuple[bool, bool]:
        assert copter.command(512, 1) == 0
        found = copter.last("SYS_STATUS")
        healthy = bool(found.onboard_control_sensors_health & bit)
        return bool(found.onboard_control_sensors_present & bit), healthy

    copter.run(1.0)
    assert said() == (False, True)
    copter.take_off()
    for name, value in (("FENCE_ENABLE", 1), ("FENCE_TYPE", 1), ("FENCE_ALT_MAX", 100.0)):
        copter.state.parameters.set(name, value)
    assert said() == (True, True)
    copter.state.parameters.set("FENCE_ALT_MAX", 2.0)
    assert said() == (True, False)


def test_the_estimator_has_a_position_no_sooner_than_it_can_be_armed(station: Make) -> None:
    copter = station("ardupilot")
    placed = mavlink.EKF_POS_HORIZ_ABS | mavlink.EKF_PRED_POS_HORIZ_ABS
    assert copter.mode("GUIDED") == 0

    def ready() -> bool:
        assert copter.command(512, 193) == 0
        return bool(copter.last("EKF_STATUS_REPORT").flags & placed)

    copter.run(0.6)
    assert not ready()
    copter.until(ready, 3.0)
    assert copter.command(400, 1) == 0
