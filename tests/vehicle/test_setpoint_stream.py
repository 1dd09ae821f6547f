import threading

import pytest

from missionkit.geometry import vec
from missionkit.messages import Setpoint
from missionkit.vehicle.command.setpoint_stream import (
    ZERO_VELOCITY,
    Streamer,
    TimedSetpoint,
    due,
)

NORTH = Setpoint(vec(2.0, 0.0, 0.0), 0.1)


class Bench:
    """A streamer with a clock and a wire of its own, stepped by hand."""

    def __init__(self, pace=1.0):
        self.now = 100.0
        self.sent = []
        self.listens = True
        self.streamer = Streamer(
            lambda s: self.sent.append((round(self.now - 100.0, 3), s)),
            lambda: self.listens,
            lambda: self.now,
            pace,
        )

    def run(self, seconds, step=0.05):
        for _ in range(round(seconds / step)):
            self.now += step
            self.streamer.once()


@pytest.mark.parametrize(
    ("age", "sent"),
    [
        (0.0, NORTH),
        (0.49, NORTH),
        (0.51, ZERO_VELOCITY),
        (1.49, ZERO_VELOCITY),
        (1.51, None),
        (60.0, None),
    ],
)
def test_the_age_of_a_command_decides_the_setpoint(age, sent):
    assert due(TimedSetpoint(NORTH, 10.0), 10.0 + age) is sent


def test_nothing_is_sent_before_the_first_command():
    assert due(None, 10.0) is None


def test_faster_than_real_time_a_command_ages_faster():
    assert due(TimedSetpoint(NORTH, 10.0), 10.2, pace=5.0) is ZERO_VELOCITY
    assert due(TimedSetpoint(NORTH, 10.0), 10.09, pace=5.0) is NORTH


def test_a_loop_that_hangs_brakes_at_half_a_second_and_then_is_silent():
    bench = Bench()
    bench.streamer.tell(NORTH, bench.now)
    bench.run(5.0)
    moving = [at for at, setpoint in bench.sent if setpoint is NORTH]
    still = [at for at, setpoint in bench.sent if setpoint is ZERO_VELOCITY]
    assert max(moving) <= 0.5
    assert 0.5 < min(still) <= 0.56
    assert max(still) <= 1.5


def test_a_process_that_was_stopped_wakes_up_silent():
    bench = Bench()
    bench.streamer.tell(NORTH, bench.now)
    bench.run(0.2)
    bench.now += 10.0
    before = len(bench.sent)
    bench.run(0.3)
    assert len(bench.sent) == before


def test_a_process_pause_is_noticed_when_it_ends():
    bench = Bench()
    bench.run(1.0)
    assert bench.streamer.woken == float("-inf")
    bench.now += 3.0
    bench.run(0.2)
    assert bench.streamer.woken == pytest.approx(104.05)


def test_a_pause_between_deciding_and_sending_sends_nothing():
    bench = Bench()

    def stands_still():
        bench.now += 3.0
        return True

    bench.streamer._gate = stands_still
    bench.streamer.tell(NORTH, bench.now)
    bench.streamer.once()
    assert bench.sent == []


def test_ticks_that_catch_up_are_not_fresh():
    bench = Bench()
    bench.streamer.tell(NORTH, bench.now - 3.0)
    bench.run(0.3)
    assert bench.sent == []


def test_nothing_is_sent_while_a_pilot_flies():
    bench = Bench()
    bench.streamer.tell(NORTH, bench.now)
    bench.listens = False
    bench.run(0.3)
    assert bench.sent == []


def test_after_silence_control_is_not_taken_back_automatically():
    bench = Bench()
    bench.streamer.tell(NORTH, bench.now)
    bench.run(0.1)
    bench.streamer.quiet()
    bench.run(0.4)
    assert len(bench.sent) == 2


def test_streaming_counts_from_the_last_break():
    bench = Bench()
    for _ in range(20):
        bench.streamer.tell(NORTH, bench.now)
        bench.run(0.1)
    assert bench.streamer.streaming(bench.now) == pytest.approx(2.0, abs=0.1)
    bench.listens = False
    bench.run(0.1)
    bench.listens = True
    bench.streamer.tell(NORTH, bench.now)
    bench.run(0.2)
    assert bench.streamer.streaming(bench.now) == pytest.approx(0.15, abs=0.06)
    assert bench.streamer.streaming(bench.now + 0.6) == 0.0  # the thread stood still


def test_a_link_that_refuses_does_not_end_the_thread():
    def refuse(_):
        raise RuntimeError("closed")

    streamer = Streamer(refuse, lambda: True, lambda: 0.0)
    streamer.tell(NORTH, 0.0)
    assert not streamer.once()
    assert streamer.failed == 1


def test_a_new_command_is_sent_at_once_from_its_own_thread():
    went, threads = threading.Event(), []

    def emit(_):
        threads.append(threading.current_thread().name)
        went.set()

    streamer = Streamer(emit, lambda: True, lambda: 0.0)
    streamer.start()
    try:
        streamer.tell(NORTH, 0.0)
        assert went.wait(20.0)
    finally:
        streamer.stop()
    assert threads[0] == "setpoints"
