"""Small fleets for tests."""

from __future__ import annotations

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.rehearsal.fleet import FleetFlight, rehearse_fleet
from missionkit.rehearsal.stage import Stage, stage, world_of
from missionkit.sim.fault_injection import parse_fault

LEG = """\
missionkit: 1
mission: leg
params: {start: [0, 0], to: [0, 0], height: 4.0}
vehicle: {start: $start}
camera: {use: none}
avoid: none
guards:
  near: {use: separation_below, distance: 5}
initial: up
states:
  up:
    kind: idle
    behavior: {use: take_off, height: $height}
    transitions: [{to: away, when: done}]
  away:
    kind: custom
    behavior: {use: waypoints, places: [$to], height: $height, speed: 4}
    transitions: [{to: land, when: done}, {to: never, when: near}]
  never:
    kind: custom
    behavior: {use: waypoints, places: [$to], height: $height, speed: 4}
    transitions: [{to: land, when: done}]
  land: {kind: land}
"""
"""Up, along a leg, down."""


def leg(start: str, to: str, *faults: str, seed: int = 1, height: float = 4.0) -> Stage:
    catalogue = builtin()
    settings = {"start": start, "to": to, "height": str(height)}
    mission = parse(LEG, "leg.yaml", catalogue, settings)
    return stage(
        mission, catalogue, world_of(mission, None), seed, [parse_fault(it) for it in faults]
    )


class Heard:
    """Keeps the records of each vehicle: observers of a fleet."""

    def __init__(self, *names: str) -> None:
        self.records = {name: [] for name in names}

    def observers(self):
        return {
            name: (lambda record, _, kept=kept: kept.append(record),)
            for name, kept in self.records.items()
        }

    def verdicts(self, name: str, guard: str = "near"):
        """Return time and verdict of each tick at which a vehicle asked its guard."""
        return [
            (record.now, verdict)
            for record in self.records[name]
            for asked, verdict in record.verdicts
            if asked == guard
        ]


def fly_fleet(separation: float = 2.0, operator=None, **stages: Stage) -> tuple[FleetFlight, Heard]:
    heard = Heard(*stages)
    flown = rehearse_fleet(stages, heard.observers(), separation=separation, operator=operator)
    return flown, heard
