import math

import numpy as np
import pytest
from vehicle.test_message_readings import HIGHRES

from missionkit.vehicle.autopilot_dialect import PX4
from missionkit.vehicle.link.clocks import BootClock, MissionClock
from missionkit.vehicle.link.link_lifecycle import LinkLifecycle
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.link.message_rates import QUEUED, Streams, boot_time
from missionkit.vehicle.telemetry.autopilot_state import AutopilotState
from missionkit.vehicle.telemetry.observer import Observer


class Wall:
    def __init__(self):
        self.now = 1000.0

    def __call__(self):
        return self.now


def test_mission_time_is_that_of_the_most_punctual_tick():
    clock = MissionClock(speed=2.0)
    assert clock.at(5.0) is None
    for now, late in ((0.05, 0.03), (0.10, 0.0), (0.15, 0.2)):
        clock.tick(now, 100.0 + now / 2.0 + late)
    assert clock.at(101.0) == pytest.approx(2.0)
    assert clock.wall(2.0) == pytest.approx(101.0)


def test_jitter_of_the_link_does_not_become_jitter_of_the_sensors():
    rng, clock, errors = np.random.default_rng(1), BootClock(), []
    for n in range(2000):
        boot = 30.0 + 0.01 * n
        clock.hear(boot, boot - 20.0 + 0.004 + rng.exponential(0.02))
        errors.append(clock.mission(boot) - (boot - 20.0))
    assert np.ptp(errors[200:]) < 0.002
    assert max(errors[200:]) < 0.008


def test_a_clock_that_drifts_is_followed():
    clock = BootClock()
    for n in range(3000):
        clock.hear(0.01 * n, 0.01 * n * 1.01)
    assert clock.mission(30.0) == pytest.approx(30.3, abs=0.15)


def test_messages_are_kept_with_their_time_and_grow_old():
    wall = Wall()
    cache = Cache(wall, frozenset(("STATUSTEXT",)))
    cache.put("HEARTBEAT", {"type": 2})
    cache.put("STATUSTEXT", {"text": "a"})
    cache.put("STATUSTEXT", {"text": "b"})
    wall.now += 2.0
    assert cache.latest("HEARTBEAT").arrived == 1000.0
    assert cache.latest("HEARTBEAT", max_age=1.0) is None
    assert [message["text"] for message in cache.drain("STATUSTEXT")] == ["a", "b"]
    assert cache.drain("STATUSTEXT") == []


def test_stamps_since_1970_and_zeros_are_not_taken_for_time_since_boot():
    cache = Cache(Wall())
    cache.put("A", {"time_usec": 2_500_000})
    cache.put("B", {"time_usec": 1_790_000_000_000_000})
    cache.put("C", {"time_boot_ms": 1500})
    cache.put("D", {"time_usec": 0})
    assert [boot_time(cache.latest(name)) for name in "ABCD"] == [2.5, None, 1.5, None]


def test_what_is_seen_after_the_last_inertial_sample_has_to_wait_for_the_next():
    wall, clock = Wall(), MissionClock()
    cache = Cache(wall, QUEUED)
    observer = Observer(cache, AutopilotState(cache, PX4), clock)
    clock.tick(0.0, wall.now)
    assert observer.moved_until == math.inf
    cache.put("HIGHRES_IMU", {**HIGHRES, "time_usec": 5_000_000})
    observer.observe(0.05, None, ())
    wall.now += 0.04
    cache.put("HIGHRES_IMU", {**HIGHRES, "time_usec": 5_010_000})
    observer.observe(0.1, None, ())
    assert observer.moved_until == pytest.approx(0.01)
    wall.now += 2.0
    assert observer.moved_until == math.inf


class Asked:
    """A wire that remembers for which streams it was asked."""

    def __init__(self):
        self.ids = []

    def send(self, name, **fields):
        self.ids.append(int(fields["param1"]))


def streams(rates=None, optional=frozenset()):
    wall, wire = Wall(), Asked()
    cache = Cache(wall)
    made, link = Streams(wire, cache, rates or {32: 20.0}, optional), LinkLifecycle()
    link.fire("connect")
    link.fire("answer")
    link.identified(made.forgotten)
    cache.listen(link.hear)
    cache.listen(made.hear)
    return made, cache, wall, wire


def run(made, cache, wall, seconds, rate=20.0, boot=0.0):
    for n in range(round(seconds * rate)):
        wall.now += 1.0 / rate
        cache.put("LOCAL_POSITION_NED", {"time_boot_ms": int(1e3 * (boot + n / rate))})
        if n % rate == 0:
            cache.put("HEARTBEAT", {})
        made.maintain()


def test_streams_are_requested_once_and_again_only_if_missing():
    made, cache, wall, wire = streams()
    run(made, cache, wall, 10.0)
    assert wire.ids == [32]
    for _ in range(60):
        wall.now += 0.05
        made.maintain()
    assert wire.ids.count(32) in {3, 4}


def test_a_slow_stream_is_requested_again():
    made, cache, wall, wire = streams()
    run(made, cache, wall, 10.0, rate=4.0)
    assert wire.ids.count(32) >= 4


def test_rates_are_sent_again_after_a_reboot():
    made, cache, wall, wire = streams()
    run(made, cache, wall, 5.0, boot=100.0)
    made.forgotten()
    run(made, cache, wall, 2.0, boot=0.3)
    assert wire.ids == [32, 32]


def test_rates_are_sent_again_when_the_link_comes_back():
    made, cache, wall, wire = streams({115: 50.0}, frozenset((115,)))
    cache.put("HEARTBEAT", {})
    made.maintain()
    wall.now += 4.0
    made.maintain()
    assert wire.ids == [115]
    cache.put("HEARTBEAT", {})
    made.maintain()
    assert wire.ids == [115, 115]
