"""A missing input that the mission relies on is reported, once each time."""

import numpy as np
import pytest

from missionkit.api.vehicle_flight import relied_on
from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.messages import Observation, Scan
from missionkit.vehicle.telemetry.required_inputs import Reliance

MISSION = """
missionkit: 1
mission: one
camera: {use: none}
MORE
initial: on
states: {on: {kind: idle}, land: {kind: land}}
"""


def watched(names, *spans):
    """`spans`: (s, whether scans come); return (time, problem)."""
    made, now, found = Reliance(names), 0.0, []
    for seconds, scans in spans:
        for _ in range(round(seconds / 0.05)):
            now += 0.05
            scan = Scan(now, np.empty((0, 3))) if scans else None
            found += [(now, text) for text in made.problems(Observation(now, scan=scan))]
    return found


def test_arriving_inputs_are_not_a_problem():
    assert watched(["scan"], (10.0, True), (2.9, False), (10.0, True)) == []
    assert watched([], (10.0, False)) == []


def test_a_missing_input_is_reported_each_time():
    found = watched(["scan"], (5.0, False), (1.0, True), (5.0, False), (1.0, True))
    assert [at for at, _ in found] == [pytest.approx(3.1, abs=0.1), pytest.approx(9.05, abs=0.1)]
    assert "the mission's avoidance sees nothing" in found[0][1]


@pytest.mark.parametrize(
    ("more", "inputs"),
    [
        ("", {"fix", "scan"}),
        ("navigation: {use: flow_kalman}", {"flow", "scan"}),
        ("navigation: {use: visual_inertial_ekf, external_pose: true}", {"external pose", "scan"}),
        ("navigation: {use: ud_vision_ekf}", {"image", "scan"}),
        ("navigation: {use: visual_inertial_ekf, flow: true}", {"flow", "scan"}),
    ],
)
def test_a_mission_relies_on_what_its_navigator_and_its_avoidance_need(more, inputs):
    assert relied_on(parse(MISSION.replace("MORE", more), "one", builtin())) == inputs
