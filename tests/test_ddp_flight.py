"""Flights by receding-horizon plans, past what only the scan sees; the truth is the judge."""

from __future__ import annotations

import numpy as np
import pytest
from rehearsed import flown, short

from missionkit.chart.plugin_catalogue import builtin
from missionkit.rehearsal.stage import stage
from missionkit.sim.world import Box, Cylinder, World

MISSION = """
avoid: {use: potential_field, radius: 0.5, top_speed: 0.3, clearance: 0.2, patience: 1000}
targets:
  goal: {position: [14, 3, -3]}
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 2}, transitions: [{to: fly, when: done}]}
  fly:
    kind: custom
    behavior: {use: ddp_go_to, target: goal, speed: 2, clearance: 0.4}
    transitions: [{to: land, when: done}, {to: land, after: 40}]
  land: {kind: land}
"""
PILLARS = [((4.0, 0.6), 0.3), ((7.0, 2.4), 0.3), ((9.5, 1.0), 0.5)]
COURSES = {
    "pillars": tuple(
        Cylinder(use="cylinder", at=place, radius=radius, height=5) for place, radius in PILLARS
    ),
    "wall": (Box(use="box", min=(7, 0), max=(7.5, 4), height=5),),
}


@pytest.mark.parametrize("course", COURSES)
def test_it_flies_past_what_it_sees_at_the_distance_asked_for(course):
    world = World(world="field", obstacles=COURSES[course])
    flight = flown(stage(short(MISSION), builtin(), world, 1))
    assert [to for to, _ in flight.went()] == ["fly", "land"]
    assert flight.entered("land") - flight.entered("fly") < 14.0
    rows = flight.ready.vehicle.track.rows
    rows = rows[(rows[:, 14] == 0.0) & (rows[:, 3] < -1.5)]
    assert rows[:, 19].min() > 0.4
    speeds = np.linalg.norm(np.diff(rows[:, 1:4], axis=0), axis=1) / np.diff(rows[:, 0])
    assert speeds.max() < 2.3
    assert flight.problems() == []
