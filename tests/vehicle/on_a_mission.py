"""A mission flown over the wire: faults begin at its states, its ticks and the truth are kept."""

from __future__ import annotations

from dataclasses import dataclass, field

from vehicle.flying import UNHURRIED

from missionkit.api.vehicle_flight import fly_vehicle
from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.flight_end import FlownFlight
from missionkit.engine.prepared_mission import prepare
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.link.link_address import parse as address_of
from missionkit.vehicle.link.link_lock import LinkLock

LIMIT = 300.0  # s of mission time, however a flight goes wrong

STAY = """
missionkit: 1
mission: stay
camera: {use: none}
dwell: 0.5
targets: {tree: {position: [60.0, 0.0, -2.0]}}
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 2.0}
    transitions: [{to: up, when: done}]
  up:
    kind: custom
    behavior: BEHAVIOR
    transitions: TRANSITIONS
  land:
    kind: land
"""
AHEAD = "{use: go_to, target: tree, speed: 2.0}"
NEVER = 40.0  # s until it lands anyway


def stay(behavior="hold", after=NEVER, failsafe="", more=""):
    """Return a mission that takes off to 2 m, does something there, and lands."""
    text = STAY.replace("BEHAVIOR", behavior)
    text = text.replace("TRANSITIONS", f"[{more}{{to: land, after: {after}}}]")
    last = f"failsafes: [{{name: mishap, when: {failsafe}, to: land}}]\n"
    return text + (last if failsafe else "")


@dataclass
class TimedSetpoint:
    """Records of the ticks of a flight."""

    autopilot: object
    flown: FlownFlight | None = None
    reports: list = field(default_factory=list)
    records: list = field(default_factory=list)
    events: dict = field(default_factory=dict)  # event -> mission time it was first heard
    began: dict = field(default_factory=dict)  # state -> (mission time, simulated time) of entry

    @property
    def states(self):
        return list(self.began)

    @property
    def reasons(self):
        return [fired.reason for record in self.records for fired in record.fired]

    @property
    def problems(self):
        return {problem for record in self.records for problem in record.problems}

    def verdicts(self, name):
        """Return (mission time, verdict) of a guard at every tick at which it was asked."""
        asked = [(record.now, dict(record.verdicts).get(name)) for record in self.records]
        return [(at, verdict) for at, verdict in asked if verdict is not None]


def fly_mission(autopilot, text, tmp_path, strikes=None, catalogue=None, **options):
    """Fly a mission; `strikes[state](mission)` is called when that state is first entered."""
    catalogue = catalogue or builtin()
    address = address_of(autopilot.url)
    vehicle = MavsdkVehicle(
        address, pace=autopilot.speed, lock=LinkLock(address, tmp_path), guard=UNHURRIED, **options
    )
    mission = TimedSetpoint(autopilot, reports=vehicle.reports)

    def watch(record, seen):
        mission.records.append(record)
        for event in seen.events:
            mission.events.setdefault(event, record.now)
        if record.state not in mission.began:
            mission.began[record.state] = record.now, autopilot.now
            (strikes or {}).get(record.state, lambda _: None)(mission)

    plan = prepare(parse(text, "stay", catalogue), catalogue)
    mission.flown = fly_vehicle(plan, vehicle, (watch,), speed=autopilot.speed, time_limit=LIMIT)
    return mission


def strike(*faults, **parameters):
    """Return what lets faults begin, and sets parameters, when a state is entered."""

    def begin(mission):
        for name, value in parameters.items():
            mission.autopilot.ask(parameter=name, value=value)
        for fault in faults:
            mission.autopilot.ask(fault=fault)

    return begin
