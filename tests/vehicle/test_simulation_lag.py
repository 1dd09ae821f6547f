"""Mission time waits for a simulated autopilot whose clock lags behind the wall."""

from __future__ import annotations

import pytest
from vehicle.flying import UNHURRIED, sitl
from vehicle.on_a_mission import LIMIT, stay

from missionkit.api.vehicle_flight import fly_vehicle
from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.prepared_mission import prepare
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.link.clocks import MissionClock
from missionkit.vehicle.link.link_address import parse as address_of
from missionkit.vehicle.link.link_lock import LinkLock
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.telemetry.simulation_lag import SimulationLag


@pytest.fixture
def lag():
    """The lag at a mission time, after a message with a stamp if one is given."""
    cache = Cache(lambda: 0.0)
    measured = SimulationLag(cache)

    def after(now, boot=None):
        if boot is not None:
            cache.put("ATTITUDE_QUATERNION", {"time_boot_ms": 1000.0 * boot})
        return measured.at(now)

    return after


def test_a_clock_that_keeps_up_has_no_lag(lag):
    assert [lag(1.0, 7.0), lag(2.0, 8.0), lag(3.0, 9.0)] == [0.0] * 3


def test_time_that_the_clock_has_lost_is_its_lag(lag):
    assert lag(1.0, 7.0) == 0.0
    assert lag(2.0, 7.6) == pytest.approx(0.4)
    assert lag(3.0, 9.0) == pytest.approx(0.0)  # it has caught up


def test_silence_is_not_waited_for(lag):
    lag(1.0, 7.0)
    assert [lag(2.0), lag(3.0)] == [0.0, 0.0]


def test_a_reboot_is_no_lag(lag):
    lag(1.0, 700.0)
    assert lag(2.0, 0.5) == 0.0


def test_mission_time_stands_still_while_it_is_put_off():
    clock = MissionClock(4.0)
    clock.tick(10.0, 100.0)
    clock.put_off(0.5)
    assert clock.at(100.5) == 10.0
    assert clock.wall(10.0) == 100.5


def test_a_simulation_at_half_the_speed_that_was_asked_for_is_flown(tmp_path):
    catalogue, seen = builtin(), {}
    plan = prepare(parse(stay(after=2.0), "stay", catalogue), catalogue)
    with sitl(speed=2.0) as autopilot:
        address = address_of(autopilot.url)
        lock, speed = LinkLock(address, tmp_path), 2.0 * autopilot.speed
        vehicle = MavsdkVehicle(address, pace=speed, lock=lock, guard=UNHURRIED)

        def watch(record, _):
            seen.setdefault("began", (record.now, autopilot.now))
            seen["ended"] = (record.now, autopilot.now)

        flown = fly_vehicle(plan, vehicle, (watch,), speed=speed, time_limit=LIMIT)
    spans = [b - a for a, b in zip(seen["began"], seen["ended"], strict=True)]
    assert flown.end.value == "landed"
    assert spans[0] < 1.3 * spans[1]  # of the mission and of the simulation
