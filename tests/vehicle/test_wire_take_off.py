"""A pilot's hold during the take-off does not end it: the climb is finished first."""

from __future__ import annotations

import asyncio

import pytest
from vehicle.flying import UNHURRIED, sitl
from vehicle.on_a_mission import LIMIT, stay

from missionkit.api.vehicle_flight import fly_vehicle
from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.prepared_mission import prepare
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.link.link_address import parse as address_of
from missionkit.vehicle.link.link_lock import LinkLock

HEIGHT = 4.0  # m
TAKEN = 3.0  # s for which the pilot has control


@pytest.mark.parametrize(("dialect", "mode"), [("px4", "LOITER"), ("ardupilot", "BRAKE")])
def test_a_climb_interrupted_by_a_pilot_is_finished_before_the_mission_continues(
    dialect, mode, tmp_path
):
    catalogue, heights, taken, back = builtin(), {}, [], []
    text = stay(after=0.5).replace("height: 2.0", f"height: {HEIGHT}")
    with sitl(dialect) as autopilot:
        address = address_of(autopilot.url)
        lock = LinkLock(address, tmp_path)
        vehicle = MavsdkVehicle(address, pace=autopilot.speed, lock=lock, guard=UNHURRIED)

        def watch(record, seen):
            height = -float(record.estimate.position[2])
            heights.setdefault(record.state, height)
            if not taken and record.state == "idle" and height > 0.8:
                autopilot.ask(fault=f"pilot_mode={mode}")
                taken.append(record.now)
            if taken and not back and record.now > taken[0] + TAKEN:
                assert not vehicle.in_control
                assert record.state == "idle"
                assert height < HEIGHT - 1.0
                back.append(record.now)
                asyncio.get_running_loop().call_soon(vehicle.resume_control)

        plan = prepare(parse(text, "stay", catalogue), catalogue)
        fly_vehicle(plan, vehicle, (watch,), speed=autopilot.speed, time_limit=LIMIT)
    assert back
    assert heights["up"] >= HEIGHT - 0.6
    assert "land" in heights
