"""A battery that sags in flight: the mission lands, and where it does not, the autopilot does."""

import pytest
from vehicle.flying import BRISK, sitl
from vehicle.on_a_mission import fly_mission, stay, strike

from missionkit.engine.flight_end import FlightEnd

LOW = {"ardupilot": {"BATT_LOW_MAH": 300.0, "BATT_FS_LOW_ACT": 1}, "px4": {}}


def test_the_missions_own_failsafe_lands_first(tmp_path):
    text = stay(failsafe="{use: battery_below, floor: 0.5}")
    with sitl(speed=BRISK) as autopilot:
        mission = fly_mission(autopilot, text, tmp_path, {"up": strike("battery_sag=0.6")})
        truth = autopilot.truth
    assert mission.reasons[-1] == "failsafe mishap"
    assert mission.flown.end is FlightEnd.LANDED
    assert mission.began["land"][0] - mission.began["up"][0] < 3.0
    assert truth["on_ground"]
    assert not truth["crashed"]


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_a_landing_by_the_autopilot_is_not_reported_as_a_pilot(dialect, tmp_path):
    sag = strike("battery_sag=0.97", **LOW[dialect])
    with sitl(dialect, BRISK) as autopilot:
        mission = fly_mission(autopilot, stay(), tmp_path, {"up": sag})
        modes = [note["which"] for note in autopilot.notes("mode")]
        truth = autopilot.truth
    assert modes[-1] == "LAND"
    assert "failsafe_takeover" in mission.events
    assert "pilot_takeover" not in mission.events
    assert mission.flown.end is FlightEnd.GROUNDED
    assert truth["on_ground"]
    assert not truth["crashed"]
