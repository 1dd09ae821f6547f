"""A pilot takes over in the middle of a mission and gives control back: it continues there."""

import pytest
from vehicle.flying import UNHURRIED, sitl

from missionkit.api.vehicle_flight import fly_vehicle
from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.flight_end import FlightEnd
from missionkit.engine.pause import BY_PILOT
from missionkit.engine.prepared_mission import prepare
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.link.link_address import parse as address_of
from missionkit.vehicle.link.link_lock import LinkLock

ROUTE = """
missionkit: 1
mission: route
camera: {use: none}
dwell: 0.5
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 2.0}
    transitions: [{to: out, when: done}]
  out:
    kind: custom
    behavior: {use: waypoints, places: [[6, 0], {at: [6, 4], stop: true}], speed: 2}
    transitions: [{to: land, when: done}, {to: late, after: 10}]
  late: {kind: land}
  land: {kind: land}
"""
LONG = 11.0  # s with the pilot: longer than the state may last


class Pilot:
    """Takes over on the way and gives control back."""

    def __init__(self, autopilot, vehicle):
        self.autopilot, self.vehicle = autopilot, vehicle
        self.taken_at, self.given_at = None, None
        self.notes, self.states, self.places = set(), {}, []

    def __call__(self, record, _):
        self.states.setdefault(record.state, record.now)
        self.places.append(tuple(self.autopilot.truth["position"][:2]))
        if self.taken_at is None:
            if record.state == "out" and self.places[-1][0] > 2.0:
                self.autopilot.ask(fault="pilot_mode=LOITER")
                self.taken_at = record.now
        elif self.given_at is None:
            self.notes.add(record.step_note)
            if record.now > self.taken_at + LONG:
                self.vehicle.resume_control()
                self.given_at = record.now


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_a_mission_continues_where_a_pilot_took_over_and_its_clock_stood_still(dialect, tmp_path):
    catalogue = builtin()
    plan = prepare(parse(ROUTE, "route", catalogue), catalogue)
    with sitl(dialect) as autopilot:
        address = address_of(autopilot.url)
        vehicle = MavsdkVehicle(
            address, pace=autopilot.speed, lock=LinkLock(address, tmp_path), guard=UNHURRIED
        )
        pilot = Pilot(autopilot, vehicle)
        flown = fly_vehicle(plan, vehicle, (pilot,), speed=autopilot.speed, time_limit=200.0)
    assert flown.end is FlightEnd.LANDED
    assert BY_PILOT in pilot.notes
    assert list(pilot.states) == ["idle", "out", "land"]
    assert pilot.states["land"] > pilot.given_at > pilot.taken_at + LONG
    assert min(abs(north - 6.0) + abs(east) for north, east in pilot.places) < 3.5
    assert min(abs(north - 6.0) + abs(east - 4.0) for north, east in pilot.places) < 1.5
