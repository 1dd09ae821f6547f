"""Ordinary flights over the wire, in both dialects."""

import asyncio

import numpy as np
import pytest
from vehicle.flying import CORNERS, flying, free_port, sitl
from vehicle.ticked_flight import ARM, NORTH

from missionkit.errors import VehicleError
from missionkit.messages import Action
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.command.fence_upload import polygon, set_fence
from missionkit.vehicle.failsafe_parameters import FailsafeLevel
from missionkit.vehicle.link.link_address import parse
from missionkit.vehicle.link.link_lock import LinkLock
from missionkit.vehicle.preflight.inspection import inspect


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_ground_truth_follows_the_commands(dialect, tmp_path):
    async def fly(autopilot):
        async with flying(autopilot, tmp_path) as flight:
            await flight.take_off()
            height = -autopilot.truth["position"][2]
            assert 1.5 < height < 3.5
            await flight.run(3.0, NORTH)
            assert flight.status.mode == "offboard"
            moving = autopilot.truth["velocity"]
            await flight.run(3.0)
            assert flight.status.mode == "hold"
            held = autopilot.truth
            await flight.land()
            return flight, moving, held

    with sitl(dialect) as autopilot:
        flight, moving, held = asyncio.run(fly(autopilot))
        truth = autopilot.truth
    assert moving[0] == pytest.approx(2.0, abs=0.3)
    assert abs(moving[1]) < 0.3
    assert np.linalg.norm(held["velocity"]) < 0.4
    assert truth["on_ground"]
    assert not truth["armed"]
    assert not truth["crashed"]
    assert all(it.result.good for it in flight.vehicle.reports), flight.vehicle.reports
    assert "pilot_takeover" not in flight.events


def test_observations_are_complete_timely_and_near_the_truth(tmp_path):
    async def look(autopilot):
        async with flying(autopilot, tmp_path) as flight:
            await flight.ready()
            await flight.run(4.0)
            return flight.seen[-60:], autopilot.truth

    with sitl() as autopilot:
        seen, truth = asyncio.run(look(autopilot))
    imu = [sample for one in seen for sample in one.imu]
    times = np.array([sample.at for sample in imu])
    assert 280 <= len(imu) <= 310
    assert np.all(np.diff(times) > 0.0)
    np.testing.assert_allclose(np.diff(times), 0.01, atol=0.006)
    assert np.mean([s.accel for s in imu], axis=0)[2] == pytest.approx(-9.8, abs=0.3)
    fixes = [one.gnss for one in seen if one.gnss is not None]
    assert len(fixes) >= 12
    assert np.linalg.norm(np.mean([f.position for f in fixes], axis=0)[:2]) < 3.0
    heights = [one.baro.height for one in seen if one.baro is not None]
    assert len(heights) >= 25
    assert abs(np.mean(heights) + truth["position"][2]) < 1.5
    assert sum(one.mag is not None for one in seen) >= 25
    assert sum(one.battery is not None for one in seen) >= 2
    assert all(sample.at <= one.now for one in seen for sample in one.imu)
    assert all(f.at < seen[-1].now for f in fixes)


def test_a_missing_vehicle_is_reported_in_time_with_a_checklist(tmp_path):
    port = free_port()
    address = parse(f"udpin://127.0.0.1:{port}")
    vehicle = MavsdkVehicle(address, patience=0.5, lock=LinkLock(address, tmp_path))
    with pytest.raises(VehicleError) as refused:
        asyncio.run(vehicle.connect())
    text = str(refused.value)
    assert f"no autopilot answered at udpin://127.0.0.1:{port} within 0.5 s" in text
    assert f"sends to port {port}" in text


def test_two_on_one_link_are_refused_and_the_first_flies_on(tmp_path):
    async def both(autopilot):
        async with flying(autopilot, tmp_path) as flight:
            address = parse(autopilot.url)
            with pytest.raises(VehicleError, match="in use by another missionkit"):
                await MavsdkVehicle(address, lock=LinkLock(address, tmp_path)).connect()
            await flight.ready()
        async with flying(autopilot, tmp_path) as flight:
            await flight.ready()

    with sitl() as autopilot:
        asyncio.run(both(autopilot))


def test_the_preflight_report_reads_parameters_over_the_wire(tmp_path):
    async def look(autopilot):
        async with flying(autopilot, tmp_path) as flight:
            return await inspect(flight.vehicle, pace=autopilot.speed)

    with sitl() as autopilot:
        autopilot.ask(parameter="COM_OF_LOSS_T", value=5.0)
        autopilot.ask(parameter="COM_OBL_RC_ACT", value=6)
        report = asyncio.run(look(autopilot))
    checks = {check.what: check for check in report.checks}
    assert checks["COM_OF_LOSS_T"].level is FailsafeLevel.WARNING
    assert checks["COM_OBL_RC_ACT"].level is FailsafeLevel.BAD
    assert "of ours" in checks["clock"].says
    for what in ("state", "health", "home", "estimator", "gnss", "battery"):
        assert checks[what].level is FailsafeLevel.GOOD, checks[what]


def test_a_fence_reaches_the_autopilot(tmp_path):
    async def upload(autopilot):
        async with flying(autopilot, tmp_path) as flight:
            await flight.ready()
            fence = polygon(flight.vehicle.observer.origin, CORNERS)
            await flight.vehicle.call(set_fence, flight.vehicle.link, fence)
            return await flight.vehicle.call(flight.vehicle.link.download_fence)

    with sitl() as autopilot:
        assert len(asyncio.run(upload(autopilot))) == 4


def test_denied_arming_is_reported_and_no_rotor_turns(tmp_path):
    async def try_it(autopilot):
        async with flying(autopilot, tmp_path) as flight:
            await flight.ready()
            autopilot.ask(fault="arming_denied")
            await flight.until(lambda: f"{Action.ARM}_refused" in flight.events, ARM)

    with sitl() as autopilot:
        asyncio.run(try_it(autopilot))
        assert not autopilot.truth["armed"]
