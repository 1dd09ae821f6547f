"""Telemetry that stops, or repeats itself, while heartbeats go on: it is not taken for news."""

import numpy as np
import pytest
from vehicle.flying import BRISK, sitl
from vehicle.on_a_mission import AHEAD, fly_mission, stay, strike

from missionkit.engine.flight_end import FlightEnd


@pytest.mark.parametrize(
    ("dialect", "fault"), [("px4", "streams_stopped"), ("ardupilot", "streams_frozen")]
)
def test_a_vehicle_without_inertial_data_is_landed(dialect, fault, tmp_path):
    with sitl(dialect, BRISK) as autopilot:
        text = stay(AHEAD, failsafe="estimate_bad")
        mission = fly_mission(autopilot, text, tmp_path, {"up": strike(fault)})
        since = mission.began["up"][1]
        modes = [note for note in autopilot.notes("mode", since) if note["which"] == "LAND"]
        truth = autopilot.truth
    assert mission.reasons[-1] == "failsafe mishap"
    assert modes[0]["at"] - since < 5.0
    assert mission.flown.end is FlightEnd.LANDED
    assert truth["on_ground"]
    assert not truth["crashed"]
    assert np.hypot(*truth["position"][:2]) < 3.0
