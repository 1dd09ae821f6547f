"""A link that comes and goes, or carries one way only."""

import numpy as np
import pytest
from vehicle.flying import over_the_wire, sitl
from vehicle.on_a_mission import AHEAD, fly_mission, stay, strike
from vehicle.ticked_flight import NORTH


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_many_short_cuts_are_flown_through(dialect, tmp_path):
    async def script(flight, autopilot):
        await flight.cruise(autopilot)
        since = autopilot.now
        autopilot.ask(fault="link_flapping=1.4+4.5")
        await flight.run(5.0, NORTH)
        assert flight.vehicle.in_control
        assert autopilot.notes("mode", since) == []
        assert min(autopilot.speeds(since)[1]) > 1.2
        gaps = np.diff([note["at"] for note in autopilot.notes("setpoint", since)])
        assert sum(gaps[gaps > 0.6]) > 1.2

    over_the_wire(tmp_path, script, dialect)


def test_after_a_cut_that_is_too_long_a_link_that_is_back_resumes_nothing(tmp_path):
    async def script(flight, autopilot):
        await flight.cruise(autopilot)
        autopilot.patient(1.0)
        since = autopilot.now
        autopilot.ask(fault="link_flapping=4+8")
        await flight.run(7.5, NORTH)
        assert "failsafe_takeover" in flight.events
        assert not flight.vehicle.in_control
        assert [note["which"] for note in autopilot.notes("mode", since)] == ["POSCTL"]
        assert autopilot.notes("setpoint", since + 3.5) == []
        times, speeds = autopilot.speeds(since)
        assert max(speeds[times > since + 3.0]) < 0.5

    over_the_wire(tmp_path, script)


def test_a_silent_vehicle_is_still_ordered_to_land(tmp_path):
    deaf = strike("link_lost+7")
    with sitl() as autopilot:
        text = stay(AHEAD, failsafe="{use: link_lost, longer_than: 2}")
        mission = fly_mission(autopilot, text, tmp_path, {"up": deaf})
        since = mission.began["up"][1]
        modes = [note for note in autopilot.notes("mode", since) if note["which"] == "LAND"]
        truth = autopilot.truth
    assert mission.reasons[-1] == "failsafe mishap"
    assert modes[0]["at"] - since < 5.0
    assert not truth["armed"]
    assert not truth["crashed"]
    assert truth["position"][0] < 10.0
