from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

Make = Callable[..., Any]
QUIET = True
MISSION, FENCE, RALLY = 0, 1, 2
RELATIVE = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT


def item(
    vehicle: Any,
    seq: int,
    command: int,
    north: float = 0.0,
    east: float = 0.0,
    height: float = 0.0,
    kind: int = MISSION,
    p1: float = 0.0,
) -> Any:
    spot = vehicle.state.earth.spot(np.array([north, east, 0.0]))
    x, y = round(spot.latitude * 1e7), round(spot.longitude * 1e7)
    return mavlink.MAVLink_mission_item_int_message(
        1, 1, seq, RELATIVE, command, 0, 1, p1, 0, 0, 0, x, y, height, kind
    )


def upload(vehicle: Any, items: list[Any], kind: int = MISSION) -> int:
    """Answer the vehicle's requests; return the type of its MISSION_ACK."""
    vehicle.seen.clear()
    vehicle.send(mavlink.MAVLink_mission_count_message(1, 1, len(items), kind))
    for _ in range(200):
        requests, acks = vehicle.all(request_of(vehicle)), vehicle.all("MISSION_ACK")
        if acks:
            return int(acks[-1].type)
        vehicle.seen.clear()
        if requests:
            vehicle.send(items[requests[-1].seq])
        else:
            vehicle.run(0.02)
    raise AssertionError("never acknowledged")


def request_of(vehicle: Any) -> str:
    return "MISSION_REQUEST_INT" if vehicle.px4 else "MISSION_REQUEST"


def download(vehicle: Any, kind: int) -> list[Any]:
    vehicle.send(mavlink.MAVLink_mission_request_list_message(1, 1, kind))
    got = []
    for seq in range(vehicle.last("MISSION_COUNT").count):
        vehicle.send(mavlink.MAVLink_mission_request_int_message(1, 1, seq, kind))
        got.append(vehicle.last("MISSION_ITEM_INT"))
    vehicle.send(mavlink.MAVLink_mission_ack_message(1, 1, 0, kind))
    return got


@pytest.mark.parametrize("kind", [MISSION, FENCE, RALLY])
def test_a_download_returns_the_upload(either: Any, kind: int) -> None:
    commands = {MISSION: 16, FENCE: 5001, RALLY: 5100}
    items = [item(either, n, commands[kind], 10.0 * n, 5.0, 7.0, kind, p1=3.0) for n in range(3)]
    assert upload(either, items, kind) == mavlink.MAV_MISSION_ACCEPTED
    got = download(either, kind)
    if kind == MISSION and not either.px4:  # item 0 is home
        got, items = got[1:], items[1:]
    assert [(i.seq, i.command, i.x, i.y, i.z, i.param1) for i in got] == [
        (i.seq, i.command, i.x, i.y, i.z, i.param1) for i in items
    ]
    others = {MISSION, FENCE, RALLY} - {kind}
    assert not any(either.state.plans.items[other] for other in others)
    either.send(mavlink.MAVLink_mission_clear_all_message(1, 1, kind))
    assert not either.state.plans.items[kind]


def test_an_upload_survives_lost_packets(station: Make) -> None:
    px4 = station("px4", "packets_lost=0.3@0+20")
    px4.run(0.1)
    items = [item(px4, n, 16, 10.0 * n, 5.0, 7.0) for n in range(6)]
    px4.state.troubles.clear()
    px4.send(mavlink.MAVLink_mission_count_message(1, 1, len(items), MISSION))
    px4.seen.clear()  # the first request is lost
    px4.run(0.3)
    assert px4.last("MISSION_REQUEST_INT").seq == 0
    assert upload(px4, items) == mavlink.MAV_MISSION_ACCEPTED


def test_an_upload_that_stops_is_given_up(station: Make) -> None:
    px4 = station("px4")
    px4.send(mavlink.MAVLink_mission_count_message(1, 1, 3, MISSION))
    px4.run(4.0)
    assert px4.last("MISSION_ACK").type == mavlink.MAV_MISSION_OPERATION_CANCELLED


def test_items_out_of_range_are_refused(either: Any) -> None:
    either.send(mavlink.MAVLink_mission_request_int_message(1, 1, 4, MISSION))
    assert either.last("MISSION_ACK").type == mavlink.MAV_MISSION_INVALID_SEQUENCE


def test_item_0_of_an_ardupilot_mission_is_home_also_of_an_empty_one(station: Make) -> None:
    copter, px4 = station("ardupilot"), station("px4")
    copter.run(1.0)
    home = copter.state.earth.spot(copter.state.home)
    for stored in (0, 2):
        assert upload(copter, [item(copter, n, 16, 30.0, 30.0, 9.0) for n in range(stored)]) == 0
        copter.send(mavlink.MAVLink_mission_request_message(1, 1, 0, MISSION))
        got = copter.last("MISSION_ITEM")
        assert (got.command, got.frame) == (16, mavlink.MAV_FRAME_GLOBAL)
        assert (got.x, got.y, got.z) == pytest.approx(tuple(home), abs=1e-5)  # floats
    px4.send(mavlink.MAVLink_mission_request_message(1, 1, 0, MISSION))
    assert px4.last("MISSION_ACK").type == mavlink.MAV_MISSION_INVALID_SEQUENCE


def test_a_station_that_only_knows_integers_says_so(station: Make) -> None:
    copter = station("ardupilot")
    copter.send(mavlink.MAVLink_mission_count_message(1, 1, 1, MISSION))
    assert copter.last("MISSION_REQUEST").seq == 0
    assert not copter.all("MISSION_REQUEST_INT")
    copter.send(mavlink.MAVLink_mission_ack_message(1, 1, 3, MISSION))  # UNSUPPORTED
    assert copter.last("MISSION_REQUEST_INT").seq == 0
    copter.send(item(copter, 0, 16, 1.0, 2.0, 3.0))
    assert copter.last("MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED


def guided(vehicle: Any, current: int, north: float, height: float, command: int = 16) -> int:
    spot = vehicle.state.earth.spot(np.array([north, 0.0, 0.0]))
    place = (spot.latitude, spot.longitude, height)
    frame = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT
    vehicle.send(
        mavlink.MAVLink_mission_item_message(
            1, 1, 0, frame, command, current, 0, 0, 0, 0, 0, *place
        )
    )
    return int(vehicle.last("MISSION_ACK").type)


def test_an_item_with_current_2_is_flown_to_at_once(station: Make) -> None:
    copter = station("ardupilot")
    assert guided(copter, 2, 10.0, 6.0) == mavlink.MAV_MISSION_ERROR  # on the ground
    copter.take_off()
    assert guided(copter, 2, 10.0, 6.0) == mavlink.MAV_MISSION_ACCEPTED
    copter.run(12.0)
    assert copter.truth.position.tolist() == pytest.approx([10.0, 0.0, -6.0], abs=0.5)
    assert guided(copter, 3, 500.0, 9.0) == mavlink.MAV_MISSION_ACCEPTED  # the height alone
    copter.run(8.0)
    assert copter.truth.position.tolist() == pytest.approx([10.0, 0.0, -9.0], abs=0.5)
    assert guided(copter, 2, 0.0, 6.0, command=21) == mavlink.MAV_MISSION_UNSUPPORTED
    assert not copter.state.plans.mission


def test_a_mission_is_flown(either: Any) -> None:
    first = [] if either.px4 else [item(either, 0, 16)]
    steps = [(22, 0.0, 0.0, 4.0), (16, 12.0, 0.0, 4.0), (16, 12.0, 8.0, 4.0), (21, 0.0, 0.0, 0.0)]
    items = first + [item(either, len(first) + n, *step) for n, step in enumerate(steps)]
    assert upload(either, items) == mavlink.MAV_MISSION_ACCEPTED
    either.run(1.6)
    if either.px4:
        assert either.mode("MISSION") == 0
        assert either.command(400, 1) == 0
    else:
        assert either.mode("GUIDED") == 0
        assert either.command(400, 1) == 0
        assert either.command(300, 0, 0) == 0
    either.until(lambda: not either.state.armed and either.state.flown, 60)
    reached = [message.seq for message in either.all("MISSION_ITEM_REACHED")]
    assert reached == list(range(len(first), len(items) - 1))
    assert either.truth.position[:2].tolist() == pytest.approx([12.0, 8.0], abs=2.1)
    assert not either.truth.crashed


def test_without_a_mission_there_is_none_to_fly(either: Any) -> None:
    assert either.mode("MISSION" if either.px4 else "AUTO") != 0


def fence(vehicle: Any, command: int) -> list[Any]:
    corners = [(-5.0, -5.0), (-5.0, 5.0), (8.0, 5.0), (8.0, -5.0)]
    if command in {5003, 5004}:
        centre = (0.0, 0.0) if command == 5003 else (12.0, 0.0)
        return [item(vehicle, 0, command, *centre, kind=FENCE, p1=8.0 if command == 5003 else 4.0)]
    if command == 5002:
        corners = [(n + 13.0, e) for n, e in corners]
    return [item(vehicle, n, command, *c, kind=FENCE, p1=4) for n, c in enumerate(corners)]


@pytest.mark.parametrize("command", [5001, 5002, 5003, 5004])
def test_flying_into_the_fence_starts_its_failsafe(either: Any, command: int) -> None:
    assert upload(either, fence(either, command), FENCE) == mavlink.MAV_MISSION_ACCEPTED
    if not either.px4:
        either.state.parameters.set("FENCE_ENABLE", 1)
    either.take_off()
    either.run(2.5, either.velocity(2.0, 0.0, 0.0))
    assert either.state.mode.does.value == "commanded"
    either.run(2.5, either.velocity(2.0, 0.0, 0.0))
    assert either.state.mode.does.value == ("hold" if either.px4 else "return")
    assert either.state.failsafe == "geofence"


def test_limits_of_distance_and_height_are_fences_too(station: Make) -> None:
    px4 = station("px4")
    px4.state.parameters.set("GF_MAX_HOR_DIST", 6.0)
    px4.state.parameters.set("GF_ACTION", 3)
    px4.take_off()
    px4.run(5.0, px4.velocity(2.0, 0.0, 0.0))
    assert px4.state.mode.name == "RTL"
