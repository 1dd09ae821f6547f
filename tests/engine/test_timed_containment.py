"""Interrupting plug-ins that do not return. Some of them really sleep: it is the subject."""

from __future__ import annotations

import math
import signal
import threading
import time
from functools import partial

import pytest
from misbehaving import with_odd_ones
from rehearsed import flown, short_stage

from missionkit.engine import flight_loop
from missionkit.engine.clock import processor_time, stopwatch
from missionkit.engine.flight_end import FlightEnd
from missionkit.engine.timed_containment import WAITING, TimedContainment

nap = partial(time.sleep, 10.0)  # noqa: TID251 - it is what is to be interrupted
pause = partial(time.sleep, 0.05)  # noqa: TID251 - as if others had the processor


def spin() -> None:
    while True:
        pass


def test_a_sleeper_is_woken_soon_after_the_limit():
    contain = TimedContainment(stopwatch)
    started = stopwatch()
    with contain.interrupting():
        assert contain.call("sleepy", nap) is None
    assert stopwatch() - started < 5.0
    assert contain.take() == ("sleepy raised TooSlowError: did not return within 0.25 s",)


def test_an_endless_loop_is_broken_and_the_next_call_is_served():
    contain = TimedContainment(stopwatch, limit=0.1)
    with contain.interrupting():
        assert contain.call("spinning", spin) is None
        assert contain.call("quick", lambda: 3) == (3,)
    assert contain.take() == ("spinning raised TooSlowError: did not return within 0.1 s",)


def test_processor_time_excludes_other_processes():
    contain = TimedContainment(processor_time, limit=0.01)
    with contain.interrupting():
        assert contain.call("starved", pause) == (None,)
    assert contain.take() == ()


def test_its_own_processor_time_counts():
    contain = TimedContainment(processor_time, limit=0.02)
    with contain.interrupting():
        assert contain.call("spinning", spin) is None
    assert contain.take() == ("spinning raised TooSlowError: did not return within 0.02 s",)


def test_one_that_waits_is_woken_after_some_patience_and_the_next_time_soon():
    contain = TimedContainment(processor_time, limit=0.01, patience=0.5)
    with contain.interrupting():
        started = stopwatch()
        assert contain.call("sleepy", nap) is None
        first, started = stopwatch() - started, stopwatch()
        assert contain.call("sleepy", nap) is None
        assert stopwatch() - started < first
        assert contain.call("starved", pause) == (None,)
    assert contain.take() == 2 * (f"sleepy raised TooSlowError: {WAITING}",)


def test_built_in_code_is_not_interrupted():
    contain = TimedContainment(stopwatch, limit=0.01)
    with contain.interrupting():
        assert contain.call("own", partial(time.sleep, 0.03), foreign=False) == (None,)  # noqa: TID251
        time.sleep(0.03)  # noqa: TID251
    assert contain.take() == ()


def test_the_timer_is_removed_afterwards():
    before = signal.getsignal(signal.SIGALRM)
    with TimedContainment(stopwatch).interrupting():
        assert signal.getitimer(signal.ITIMER_REAL)[1] > 0.0
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
    assert signal.getsignal(signal.SIGALRM) is before


@pytest.mark.parametrize(("took", "answer"), [(0.25, ("yes",)), (0.26, None)])
def test_an_answer_that_comes_too_late_does_not_count(took, answer):
    times = iter([1.0, 1.0 + took])
    contain = TimedContainment(lambda: next(times))
    assert contain.call("slow", lambda: "yes") == answer
    assert contain.take() == (() if answer else ("slow took 0.26 s, allowed 0.25 s",))


def test_outside_the_main_thread_lateness_is_reported_without_interruption():
    times = iter([0.0, 1.0])
    contain, answers = TimedContainment(lambda: next(times)), []

    def work() -> None:
        with contain.interrupting():
            answers.append(contain.call("slow", lambda: "yes"))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert answers == [None]
    assert contain.take() == ("slow took 1.00 s, allowed 0.25 s",)


HOVERING = """\
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 3}, transitions: [{to: up, when: done}]}
  up: {kind: custom, transitions: [{to: land, when: {use: sleepy, over: 1.0}}]}
  return:
    kind: return
    behavior: {use: go_to, target: home, height: 3}
    transitions: [{to: land, when: done}]
  land: {kind: land}
"""


def test_with_a_guard_that_sleeps_the_vehicle_holds_and_goes_home(monkeypatch):
    hasty = partial(TimedContainment, limit=0.01, patience=0.05)
    monkeypatch.setattr(flight_loop, "TimedContainment", hasty)
    flight = flown(short_stage(HOVERING, catalogue=with_odd_ones()))
    assert flight.went() == [
        ("up", "when done"),
        ("return", "failsafe plug-in failed"),
        ("land", "when done"),
    ]
    assert flight.result.flown.end is FlightEnd.LANDED
    assert flight.result.grade.landed
    assert flight.entered("return") - flight.entered("up") == pytest.approx(3.0, abs=0.15)
    assert flight.problems() == [f"sleepy (over 1) raised TooSlowError: {WAITING}"]
    held = [record for record in flight.records if record.state == "up"][2:]
    assert {record.step_note for record in held} == {"holding: a plug-in misbehaves"}
    places = [record.estimate.position for record in held]
    assert max(math.dist(place[:2], places[0][:2]) for place in places) < 0.3


def test_a_rehearsal_is_the_same_on_a_machine_that_is_busy_with_other_things(monkeypatch):
    monkeypatch.setattr(flight_loop, "TimedContainment", partial(TimedContainment, limit=0.01))
    text = HOVERING.replace("{use: sleepy, over: 1.0}", "{use: starved, over: 2.0}")
    flight = flown(short_stage(text, catalogue=with_odd_ones()))
    assert flight.went() == [("up", "when done"), ("land", "when starved (over 2)")]
    assert flight.problems() == []
