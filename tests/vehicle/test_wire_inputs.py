"""Messages with parts missing, several senders or another frame, in flight; judged by the truth."""

import math

import numpy as np
import pytest
from vehicle import on_a_mission
from vehicle.flying import BRISK, sitl
from vehicle.message_filter import MessageFilter
from vehicle.on_a_mission import fly_mission, stay

from missionkit.engine.loop import End
from missionkit.sim.mavlink.dialect import mavlink
from missionkit.sim.world import Box, World

EMPTY = "{use: battery_below, floor: 0.2}"
PAST_A_WALL = """
missionkit: 1
mission: past-a-wall
camera: {use: none}
dwell: 0.5
targets: {pole: {position: [24.0, 0.0, -4.0]}}
initial: up
states:
  up:
    kind: idle
    behavior: {use: take_off, height: 4}
    transitions: [{to: out, when: done}]
  out:
    kind: gps
    behavior: {use: go_to, target: pole, speed: 3}
    transitions: [{to: land, when: done}]
  land: {kind: land}
"""
WALL = World(
    world="wall",
    start_yaw_deg=90.0,
    obstacles=(Box(use="box", min=(12.0, -6.0), max=(13.0, 4.0), height=12.0),),
)


def near(truth, north, east):
    return math.hypot(truth["position"][0] - north, truth["position"][1] - east)


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_a_receiver_without_course_leads_to_the_target_all_the_same(dialect, tmp_path):
    there = "{use: go_to, target: tree, speed: 3.0}"
    text = stay(there, more="{to: land, when: done}, ").replace("[60.0, 0.0", "[12.0, 5.0")
    with sitl(dialect, BRISK) as autopilot:
        MessageFilter(autopilot).change("GPS_RAW_INT", cog=65535)
        told = fly_mission(autopilot, text, tmp_path)
        truth = autopilot.truth
    assert told.flown.end is End.LANDED
    assert near(truth, 12.0, 5.0) < 3.0
    assert max(record.now for record in told.records if record.state == "up") < 30.0


def test_without_any_fix_it_stays_on_the_ground_though_the_autopilot_is_ready(
    tmp_path, monkeypatch
):
    monkeypatch.setattr(on_a_mission, "LIMIT", 10.0)
    nothing = {"fix_type": 1, "lat": 0, "lon": 0, "alt": 0, "vel": 65535, "cog": 65535}
    with sitl(speed=BRISK) as autopilot:
        MessageFilter(autopilot).change("GPS_RAW_INT", satellites_visible=0, **nothing)
        told = fly_mission(autopilot, stay(), tmp_path)
        truth, armed = (
            autopilot.truth,
            [n for n in autopilot.notes("command") if "400" in n["which"]],
        )
    assert told.flown.end is End.NEVER_LEFT
    assert any(record.estimate.status.ready for record in told.records if record.estimate.status)
    assert any("waiting for a position" in record.step_note for record in told.records)
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
        told = fly_mission(autopilot, stay(failsafe=EMPTY), tmp_path, drained)
        truth = autopilot.truth
    assert told.flown.end is End.LANDED
    assert told.reasons[-1] == "failsafe mishap"
    assert truth["on_ground"]


def test_a_ring_aligned_with_north_keeps_it_off_the_wall(tmp_path):
    """As MAVROS and many sensors send it; the vehicle starts with its nose to the east."""
    with sitl(speed=4.0, world=WALL) as autopilot:
        link, heading = MessageFilter(autopilot), [math.pi / 2]

        def note(message):
            turn = 1.0 - 2.0 * (message.q3**2 + message.q4**2)
            heading[0] = math.atan2(2.0 * (message.q1 * message.q4 + message.q2 * message.q3), turn)
            return [message]

        def turned(message):
            message.angle_offset += math.degrees(heading[0])
            message.frame = mavlink.MAV_FRAME_GLOBAL
            return [message]

        link.on("ATTITUDE_QUATERNION", note)
        link.on("OBSTACLE_DISTANCE", turned)
        told = fly_mission(autopilot, PAST_A_WALL, tmp_path)
        truth = autopilot.truth
        rows = np.array(autopilot.ask(track=True, since=0.0)["rows"], dtype=float)
    assert told.flown.end is End.LANDED
    assert not truth["crashed"]
    flown = rows[rows[:, 3] < -2.0]
    assert flown[:, 19].min() > 0.5
    assert near(truth, 24.0, 0.0) < 4.0


def test_a_ring_in_a_frame_that_is_not_known_is_a_problem_in_the_record(tmp_path, monkeypatch):
    monkeypatch.setattr(on_a_mission, "LIMIT", 4.0)
    with sitl(speed=BRISK) as autopilot:
        MessageFilter(autopilot).change("OBSTACLE_DISTANCE", frame=21)
        told = fly_mission(autopilot, stay(), tmp_path)
    assert [problem for problem in told.problems if "MAV_FRAME 21" in problem]
