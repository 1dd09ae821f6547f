"""Position and attitude setpoints, the flight home, and what is shared, over the wire."""

import asyncio

import numpy as np
import pytest
from vehicle.flying import BRISK, flying, sitl

from missionkit.geometry import from_euler, vec, yaw_of
from missionkit.messages import Action, AttitudeSetpoint, Command, PositionSetpoint

HOME = Command(action=Action.RETURN)
PLACE = Command(PositionSetpoint(vec(3.0, -2.0, -4.0), 0.8))


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_a_position_is_flown_to_and_a_return_lands_at_home(dialect, tmp_path):
    async def fly(autopilot):
        async with flying(autopilot, tmp_path) as flight:
            await flight.take_off()
            await flight.run(10.0, PLACE)
            assert flight.status.mode == "offboard"
            there = autopilot.truth
            await flight.until(lambda: flight.status.mode == "return", HOME)
            await flight.until(lambda: not flight.status.armed, HOME, 90.0)
            return flight, there, autopilot.truth

    with sitl(dialect, BRISK) as autopilot:
        if dialect == "ardupilot":
            autopilot.ask(parameter="RTL_ALT", value=500.0)
        flight, there, end = asyncio.run(fly(autopilot))
    np.testing.assert_allclose(there["position"], (3.0, -2.0, -4.0), atol=0.6)
    assert yaw_of(np.array(there["attitude"])) == pytest.approx(0.8, abs=0.15)
    assert np.hypot(*end["position"][:2]) < 1.5
    assert end["on_ground"]
    assert not end["crashed"]
    assert all(report.result.good for report in flight.vehicle.reports), flight.vehicle.reports
    assert "pilot_takeover" not in flight.events


def test_an_attitude_leans_the_vehicle_and_a_stale_one_stops_it(tmp_path):
    async def fly(autopilot):
        async with flying(autopilot, tmp_path) as flight:
            await flight.take_off()
            lean = Command(AttitudeSetpoint(from_euler(0.0, -0.15, 0.0), 0.5))
            await flight.until(lambda: autopilot.truth["velocity"][0] > 0.8, lean)
            since = autopilot.now
            await asyncio.sleep(1.2 / autopilot.speed)
            return autopilot.speeds(since)

    with sitl() as autopilot:
        _, speeds = asyncio.run(fly(autopilot))
    assert max(speeds) > 0.5
    assert speeds[-1] < 0.6 * max(speeds)


@pytest.mark.parametrize(("dialect", "most"), [("px4", 15.0), ("ardupilot", 3.5)])
def test_no_autopilot_flies_on_to_a_position_when_missionkit_goes_silent(dialect, most, tmp_path):
    far = Command(PositionSetpoint(vec(40.0, 0.0, -3.0), 0.0))

    async def fly(autopilot):
        async with flying(autopilot, tmp_path) as flight:
            await flight.take_off()
            await flight.until(lambda: autopilot.truth["velocity"][0] > 1.0, far)
            flight.vehicle.streamer.stop()
            before = autopilot.truth["position"][0]
            await flight.until(lambda: abs(autopilot.truth["velocity"][0]) < 0.2, far)
            return autopilot.truth["position"][0] - before

    with sitl(dialect) as autopilot:
        if dialect == "px4":
            autopilot.patient(1.0)
        assert 0.0 < asyncio.run(fly(autopilot)) < most
