"""Messages with parts missing, several senders or another frame, in flight; judged by the truth."""

import asyncio
import math

import numpy as np
import pytest
from vehicle import on_a_mission
from vehicle.flying import BRISK, flying, over_the_wire, sitl
from vehicle.message_filter import MessageFilter
from vehicle.on_a_mission import fly_mission, stay
from vehicle.ticked_flight import NORTH

from missionkit.engine.flight_end import FlightEnd
from missionkit.geometry import from_euler, to_matrix
from missionkit.sim.world import Box, World
from missionkit.sitl.pymavlink_dialect import mavlink

EMPTY = "{use: battery_below, floor: 0.2}"
WALL = World(
    world="wall",
    start_yaw_deg=90.0,
    obstacles=(Box(use="box", min=(8.0, -6.0), max=(9.0, 4.0), height=12.0),),
)


def near(truth, north, east):
    return math.hypot(truth["position"][0] - north, truth["position"][1] - east)


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_a_receiver_without_course_still_leads_to_the_target(dialect, tmp_path):
    there = "{use: go_to, target: tree, speed: 3.0}"
    text = stay(there, more="{to: land, when: done}, ").replace("[60.0, 0.0", "[12.0, 5.0")
    with sitl(dialect, BRISK) as autopilot:
        MessageFilter(autopilot).change("GPS_RAW_INT", cog=65535)
        mission = fly_mission(autopilot, text, tmp_path)
        truth = autopilot.truth
    assert mission.flown.end is FlightEnd.LANDED
    assert near(truth, 12.0, 5.0) < 3.0
    assert max(record.now for record in mission.records if record.state == "up") < 30.0


def test_without_any_fix_it_stays_on_the_ground_though_the_autopilot_is_ready(
    tmp_path, monkeypatch
):
    monkeypatch.setattr(on_a_mission, "LIMIT", 10.0)
    nothing = {"fix_type": 1, "lat": 0, "lon": 0, "alt": 0, "vel": 65535, "cog": 65535}
    with sitl(speed=BRISK) as autopilot:
        MessageFilter(autopilot).change("GPS_RAW_INT", satellites_visible=0, **nothing)
        mission = fly_mission(autopilot, stay(), tmp_path)
        truth, armed = (
            autopilot.truth,
            [n for n in autopilot.notes("command") if "400" in n["which"]],
        )
    assert mission.flown.end is FlightEnd.NEVER_LEFT
    assert any(record.estimate.status.ready for record in mission.records if record.estimate.status)
    assert any("waiting for a position fix" in record.step_note for record in mission.records)
    assert truth["on_ground"]
    assert not armed


def test_an_empty_pack_is_not_hidden_by_a_full_one_for_the_payload(tmp_path):
    full = mavlink.MAVLink_battery_status_message(
        1, mavlink.MAV_BATTERY_FUNCTION_PAYLOAD, 1, 2500, [4100] * 4 + [65535] * 6, 10, 0, -1, 95
    )

    def empty(message):
        message.battery_remaining = 8
        return [message, full]

    with sitl(speed=BRISK) as autopilot:
        link = MessageFilter(autopilot)
        link.on("BATTERY_STATUS", lambda message: [message, full])
        drained = {"up": lambda _: link.on("BATTERY_STATUS", empty)}
        mission = fly_mission(autopilot, stay(failsafe=EMPTY), tmp_path, drained)
        truth = autopilot.truth
    assert mission.flown.end is FlightEnd.LANDED
    assert mission.reasons[-1] == "failsafe mishap"
    assert truth["on_ground"]


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_a_ring_aligned_with_north_shows_the_wall_where_it_is(dialect, tmp_path):
    """As MAVROS and many sensors send it; the vehicle stands with its nose to the east."""

    async def script(flight, autopilot):
        def turned(message):
            message.angle_offset += WALL.start_yaw_deg
            message.frame = mavlink.MAV_FRAME_GLOBAL
            return [message]

        MessageFilter(autopilot).on("OBSTACLE_DISTANCE", turned)
        await flight.ready()
        flight.seen.clear()
        await flight.until(lambda: [seen for seen in flight.seen if seen.scan is not None])
        points = flight.seen[-1].scan.points @ to_matrix(from_euler(0.0, 0.0, math.pi / 2)).T
        np.testing.assert_allclose(points[:, 0], 8.0, atol=0.6)
        assert np.ptp(points[:, 1]) > 6.0

    over_the_wire(tmp_path, script, dialect, world=WALL)


def test_a_ring_in_a_frame_that_is_not_known_is_a_problem_in_the_record(tmp_path, monkeypatch):
    monkeypatch.setattr(on_a_mission, "LIMIT", 4.0)
    with sitl(speed=BRISK) as autopilot:
        MessageFilter(autopilot).change("OBSTACLE_DISTANCE", frame=21)
        mission = fly_mission(autopilot, stay(), tmp_path)
    assert [problem for problem in mission.problems if "MAV_FRAME 21" in problem]


SPRAYER = NORTH._replace(payload="sprayer")


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_the_payload_is_switched_off_when_a_pilot_takes_over(dialect, tmp_path):
    async def script(flight, autopilot):
        await flight.cruise(autopilot)
        await flight.until(lambda: autopilot.truth["payload"], SPRAYER)
        autopilot.ask(fault="pilot_mode")
        await flight.until(lambda: not flight.vehicle.in_control, SPRAYER)
        await flight.until(lambda: not autopilot.truth["payload"], SPRAYER)
        await flight.run(2.0, SPRAYER)
        assert not autopilot.truth["payload"]

    over_the_wire(tmp_path, script, dialect)


def test_the_payload_is_switched_off_at_the_end(tmp_path):
    async def script(flight, autopilot):
        await flight.take_off()
        await flight.until(lambda: autopilot.truth["payload"], SPRAYER)

    with sitl() as autopilot:

        async def fly():
            async with flying(autopilot, tmp_path) as flight:
                await script(flight, autopilot)

        asyncio.run(fly())
        assert not autopilot.truth["payload"]


def test_a_simulation_slower_than_a_third_of_real_time_is_reached(tmp_path):
    async def script(flight, _):
        await flight.until(lambda: flight.status is not None)
        beats = flight.vehicle.state.heard
        await flight.until(lambda: flight.vehicle.state.heard > beats)

    over_the_wire(tmp_path, script, speed=0.25)
