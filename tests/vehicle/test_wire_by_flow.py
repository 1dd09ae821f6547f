"""Without satellites, by optical flow and range over the wire; judged by the truth."""

import numpy as np
import pytest
from vehicle.flying import UNHURRIED, sitl

from missionkit.api.vehicle_flight import fly_vehicle
from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.flight_end import FlightEnd
from missionkit.engine.prepared_mission import prepare
from missionkit.sitl import arming_rules
from missionkit.sitl.flight_modes import FlightTask
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.link.link_address import parse as address_of
from missionkit.vehicle.link.link_lock import LinkLock

SPEED = 4.0
LIMIT = 60.0  # s, however it goes wrong
BY_FLOW = {"px4": {"EKF2_OF_CTRL": 1}, "ardupilot": {"EK3_SRC1_VELXY": 5}}
TRIP = """
missionkit: 1
mission: by-flow
camera: {use: none}
navigation: {use: flow_kalman}
dwell: 0.5
targets: {goal: {position: [3.0, 2.0, -2.0]}}
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 2.0, by: LAUNCH}
    transitions: [{to: out, when: done}]
  out:
    kind: gps
    behavior: {use: go_to, target: goal, speed: 1.0}
    transitions: [{to: land, when: done}]
  land: {kind: land}
"""


class Pilot:
    """Arms and climbs to 2 m by hand once the estimate is aligned, then gives control."""

    def __init__(self, autopilot, vehicle):
        self.state, self.vehicle = autopilot.server.autopilot.state, vehicle
        self._next = self._climb

    def __call__(self, record, _):
        self._next(record)

    def _climb(self, record):
        if record.step_note == "waiting for the pilot to take off":
            arming_rules.arm(self.state)
            self.state.height = 2.0
            self.state.fly(FlightTask.TAKE_OFF)
            self._next = self._hover

    def _hover(self, _):
        if self.state.body.truth.position[2] < -1.8:
            self.state.enter(self.state.dialect.named("POSCTL"))
            self._next = self._give

    def _give(self, record):
        if "waiting for control" in record.step_note and not self.vehicle.in_control:
            self.vehicle.resume_control()
            self._next = lambda _: None


def fly(dialect, tmp_path, launch="autopilot"):
    with sitl(dialect, SPEED, faults=("gnss_lost",), parameters=BY_FLOW[dialect]) as autopilot:
        address = address_of(autopilot.url)
        lock = LinkLock(address, tmp_path)
        vehicle = MavsdkVehicle(address, pace=autopilot.speed, lock=lock, guard=UNHURRIED)
        records, pilot = [], Pilot(autopilot, vehicle)
        watchers = [lambda record, _: records.append(record)]
        watchers += [pilot] if launch == "pilot" else []
        plan = prepare(parse(TRIP.replace("LAUNCH", launch), "trip", builtin()), builtin())
        flown = fly_vehicle(plan, vehicle, watchers, speed=autopilot.speed, time_limit=LIMIT)
        return flown, records, autopilot.truth, autopilot.notes("command")


def arrived(flown, truth):
    assert flown.end is FlightEnd.LANDED
    assert truth["on_ground"]
    assert not truth["crashed"]
    return np.hypot(truth["position"][0] - 3.0, truth["position"][1] - 2.0) < 2.0


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_it_flies_to_its_goal_by_what_looks_down(dialect, tmp_path):
    flown, records, truth, _ = fly(dialect, tmp_path)
    assert arrived(flown, truth)
    assert {record.estimate.health.gnss_at for record in records} == {None}


def test_launched_by_a_pilot_it_is_flown_after_control_is_given_back(tmp_path):
    flown, records, truth, commands = fly("px4", tmp_path, "pilot")
    assert arrived(flown, truth)
    assert not [note for note in commands if note["which"].startswith(("400", "22 "))]
    out = next(record for record in records if record.state == "out")
    assert -out.estimate.position[2] == pytest.approx(2.0, abs=0.5)
