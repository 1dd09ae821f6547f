"""A vehicle whose time passes more slowly than it should, and a link on which messages queue up."""

import numpy as np
import pytest
from vehicle.test_message_readings import FIX
from vehicle.test_observer import HOME, turned
from vehicle.test_time import Wall

from missionkit.estimation.builder import build
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.geometry import IDENTITY, Transform, vec
from missionkit.vehicle.autopilot_dialect import ARDUPILOT
from missionkit.vehicle.link.clocks import SLACK, BootClock, MissionClock
from missionkit.vehicle.link.message_cache import Cache, Message
from missionkit.vehicle.link.message_rates import QUEUED
from missionkit.vehicle.link.time_sync import TimeSync
from missionkit.vehicle.telemetry.autopilot_state import AutopilotState
from missionkit.vehicle.telemetry.observer import Observer
from missionkit.vehicle.telemetry.raw_imu_conversion import RawImuConverter

STEP, TICK = 0.01, 5  # s of the mission; steps
AXES = {f"{axis}{what}": 0 for axis in "xyz" for what in ("acc", "gyro", "mag")}
STANDING = {**AXES, "zacc": -1000, "xmag": 500, "zmag": 500}
LOCAL = dict.fromkeys(("x", "y", "z", "vx", "vy", "vz"), 0.0)


class Starved:
    """An ArduPilot that stands on the ground, three times as fast as the wall if it can.

    Args:
        rate: at which its time passes, of what it should be.
        queued: s per s by which messages on their way here grow older, once the filter has aligned.
        answers: whether it answers TIMESYNC.
    """

    def __init__(self, rate=1.0, queued=0.0, *, answers=True):
        self.rate, self.queued, self.answers, self.due = rate, queued, answers, 0.0
        self.wall, self.clock, self.now, self.steps = Wall(), MissionClock(3.0), 0.0, 0
        self.cache, self.notes = Cache(self.wall, QUEUED), []
        self.sync = TimeSync(self, self.wall, 3.0, self.notes.append)
        state = AutopilotState(self.cache, ARDUPILOT)
        self.observer = Observer(self.cache, state, self.clock, self.sync.take)
        self.put = RawImuConverter(self.cache.put)
        self.cache.listen(self.sync.hear)
        self.put("HOME_POSITION", HOME)
        self.navigator = build(VisualInertialEkf(), {}, Transform(IDENTITY, vec(0.0, 0.0, 0.0)))
        self.known, self.waiting = self.navigator.begin(), []

    def send(self, name, **fields):
        assert name == "TIMESYNC"
        if self.answers:
            self.say(name, {**fields, "tc1": int(1e9 * self.boot)})

    @property
    def boot(self):
        return 5.0 + STEP * self.steps

    def say(self, name, fields):
        late = self.queued * max(self.now - 5.0, 0.0)
        self.waiting.append((self.now + late, name, fields))

    def step(self):
        self.steps += 1
        n, micros = self.steps, round(1e6 * self.boot)
        self.say("RAW_IMU", {**STANDING, "time_usec": micros})
        if n % 2 == 0:
            self.say("ATTITUDE_QUATERNION", turned(boot=micros // 1000))
        if n % 4 == 0:
            self.say("LOCAL_POSITION_NED", {**LOCAL, "time_boot_ms": micros // 1000})
        if n % 10 == 0:
            self.say("SCALED_PRESSURE", {"press_abs": 950.0})
        if n % 20 == 0:
            self.say("GPS_RAW_INT", {**FIX, "vel": 0, "time_usec": micros - 100_000})

    def fly(self, seconds):
        """Return (time, aligned, diverged, age of the newest sample) of every tick."""
        rows = []
        for n in range(round(seconds / STEP)):
            self.now += STEP
            self.wall.now += STEP / 3.0
            self.due += STEP * self.rate
            while STEP * self.steps < self.due:
                self.step()
            for _, name, fields in [it for it in self.waiting if it[0] <= self.now]:
                self.put(name, fields)
            self.waiting = [it for it in self.waiting if it[0] > self.now]
            if n % TICK == TICK - 1:
                rows.append(self.tick())
        return np.array(rows)

    def tick(self):
        self.clock.tick(self.now, self.wall.now)
        self.sync.ask()
        seen = self.observer.observe(self.now, None, ())
        self.known = self.navigator.propagate(self.known, seen)
        health = self.navigator.read(self.known).health
        return self.now, health.aligned, health.diverged, self.now - self.observer.moved_until


@pytest.mark.parametrize("rate", [0.9, 0.75, 0.5])
def test_a_vehicle_whose_time_passes_slowly_does_not_seem_silent(rate):
    """As a simulated one on a busy machine: its estimate would have diverged for ever."""
    vehicle = Starved(rate)
    rows = vehicle.fly(20.0)
    aligned = rows[rows[:, 1] == 1.0]
    assert len(aligned) > 200
    assert not aligned[:, 2].any()
    assert rows[20:, 3].max() < 0.4


def test_a_paused_vehicle_is_trusted_again_as_soon_as_it_continues():
    vehicle = Starved()
    vehicle.fly(5.0)
    vehicle.rate = 0.0
    assert vehicle.fly(4.0)[-1, 2]
    vehicle.rate = 1.0
    assert not vehicle.fly(10.0)[30:, 2].any()


def test_a_slow_vehicle_clock_is_reported_once():
    punctual, slow = Starved(0.97), Starved(0.75)
    punctual.fly(40.0)
    slow.fly(40.0)
    assert punctual.notes == []
    (said,) = slow.notes
    assert "0.75 of the rate" in said


def test_messages_that_queue_up_on_the_link_are_not_taken_for_fresh_ones():
    """Asking for the time does not hide it: what is felt grows old, and that is noticed."""
    asked, unasked = (Starved(queued=0.2, answers=it).fly(12.0) for it in (True, False))
    assert asked[-1, 2]
    np.testing.assert_allclose(asked[:, 3], unasked[:, 3], atol=0.02)


def test_an_answer_to_another_peer_or_from_another_clock_changes_nothing():
    wall, clock = Wall(), BootClock()
    sync = TimeSync(Starved(), wall, 1.0, [].append)
    sync.hear(Message("TIMESYNC", {"tc1": 10**9, "ts1": 12345}, wall.now))
    assert sync.take() == []
    clock.hear(boot=5.0, arrived=7.1)
    clock.answered(boot=5.2, requested_at=7.2)
    assert clock.mission(5.0) == pytest.approx(7.1)
    clock.answered(boot=1.0, requested_at=7.2)
    assert clock.mission(5.0) == pytest.approx(7.1)


def test_the_offset_follows_answers_until_a_message_shows_that_the_vehicle_has_caught_up():
    clock = BootClock()
    clock.hear(boot=5.0, arrived=7.0)
    clock.hear(boot=6.0, arrived=9.0)
    assert clock.mission(6.0) == pytest.approx(8.0)
    clock.answered(boot=6.0, requested_at=8.1)
    assert clock.mission(6.0) == pytest.approx(8.0)
    clock.answered(boot=6.0, requested_at=8.7)
    assert clock.mission(6.0) == pytest.approx(8.7 - SLACK)
    clock.hear(boot=7.0, arrived=9.4)
    assert clock.mission(7.0) == pytest.approx(9.4 - SLACK)
    clock.hear(boot=8.0, arrived=10.1)
    assert clock.mission(8.0) == pytest.approx(10.0)
    clock.forget()
    assert clock.mission(7.0) is None
