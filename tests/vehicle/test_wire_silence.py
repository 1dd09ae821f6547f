"""Silence is safe: whatever happens to the process, the vehicle does not fly on.

Judged by the simulated autopilot's truth. It flies north at 2 m/s when the fault begins; times are
the vehicle's. The autopilot's own time-out is longer than what is asked of the guardian: 5 s for
PX4 here, ArduPilot's default of 3 s.
"""

import asyncio
import os
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from child import default_signals
from vehicle.flying import flying, over_the_wire, sitl, until
from vehicle.ticked_flight import NORTH

from missionkit.vehicle.guardian.policy import USUAL, Patience

SLOW = 3.0  # times real time: a busy machine does not count as silence
WITHIN = 3.2  # s; 2.4 s as a rule, on a busy machine a little more; without a guardian 3.65 s
TESTS = str(Path(__file__).parents[1])


def stopped_after(autopilot, since):
    """Return how long it took (s) until it moved at less than half a metre a second for good."""
    times, speeds = autopilot.speeds(since)
    moving = np.flatnonzero(speeds >= 0.5)
    return 0.0 if not len(moving) else float(times[moving[-1]] - since)


@contextmanager
def client(autopilot, tmp_path):
    """Run a client that flies north."""
    command = [sys.executable, "-m", "vehicle.client"]
    command += [autopilot.url, str(autopilot.speed), str(tmp_path)]
    env = {**os.environ, "PYTHONPATH": TESTS}
    pipes = {"stdout": subprocess.PIPE, "preexec_fn": default_signals}
    with subprocess.Popen(command, env=env, **pipes) as process:
        try:
            word, guardian = process.stdout.readline().split()
            assert word == b"flying"
            until(lambda: autopilot.truth["velocity"][0] > 1.8)
            yield process, int(guardian)
        finally:
            process.kill()


def assert_held(autopilot, since):
    """Assert that the vehicle was commanded to hold, and that nothing was resumed."""
    modes = [note["which"] for note in autopilot.notes("mode", since)]
    assert (
        modes == {"px4": ["LOITER"], "ardupilot": []}[autopilot.server.autopilot.state.dialect.name]
    )
    times, speeds = autopilot.speeds(since)
    assert max(speeds[times > since + WITHIN]) < 0.5


def test_a_loop_that_hangs_brakes_at_half_a_second_and_nothing_is_resumed(tmp_path):
    async def hang(autopilot):
        async with flying(autopilot, tmp_path, guard=USUAL) as flight:
            await flight.cruise(autopilot)
            since = autopilot.now
            threading.Event().wait(4.0 / autopilot.speed)  # in the loop's own thread
            await flight.run(3.0, NORTH)
            assert not flight.vehicle.in_control
            return since, flight

    with sitl(speed=SLOW) as autopilot:
        since, flight = asyncio.run(hang(autopilot))
        times, speeds = autopilot.speeds(since)
        modes = [note["which"] for note in autopilot.notes("mode", since)]
        assert stopped_after(autopilot, since) < WITHIN
    assert speeds[np.searchsorted(times, since + 1.0)] < 1.0
    assert modes == ["LOITER"]
    assert "failsafe_takeover" in flight.events


HOW = [
    (signal.SIGKILL, "px4"),
    (signal.SIGKILL, "ardupilot"),
    (signal.SIGSTOP, "px4"),
    (signal.SIGSTOP, "ardupilot"),
    (signal.SIGUSR1, "ardupilot"),
]


@pytest.mark.parametrize(("how", "dialect"), HOW)
def test_a_process_that_stops_dies_or_stalls_is_stopped_by_its_guardian(how, dialect, tmp_path):
    with sitl(dialect, SLOW) as autopilot, client(autopilot, tmp_path) as (process, _):
        since = autopilot.now
        process.send_signal(how)
        until(lambda: autopilot.now > since + 2.5)
        process.send_signal(signal.SIGCONT)
        until(lambda: autopilot.now > since + 4.5)
        assert stopped_after(autopilot, since) < WITHIN
        assert_held(autopilot, since)


def test_a_storm_of_garbage_collections_ends_in_holding(tmp_path):
    with sitl("ardupilot", SLOW) as autopilot, client(autopilot, tmp_path) as (process, _):
        since = autopilot.now
        process.send_signal(signal.SIGUSR2)
        until(lambda: autopilot.now > since + 5.5)
        assert stopped_after(autopilot, since) < WITHIN
        assert_held(autopilot, since)


@pytest.mark.parametrize(("dialect", "loss"), [("px4", "COM_OF_LOSS_T"), ("ardupilot", None)])
def test_with_the_guardian_killed_as_well_the_autopilots_own_time_out_acts(dialect, loss, tmp_path):
    with sitl(dialect, SLOW) as autopilot, client(autopilot, tmp_path) as (process, guardian):
        autopilot.ask(parameter=loss or "GUID_TIMEOUT", value=1.0)
        since = autopilot.now
        process.send_signal(signal.SIGSTOP)  # so that it cannot start another guardian
        os.kill(guardian, signal.SIGKILL)
        process.kill()
        until(lambda: autopilot.now > since + 6.0)
        setpoints = [note["at"] - since for note in autopilot.notes("setpoint", since)]
        assert all(at < 0.5 for at in setpoints)
        assert stopped_after(autopilot, since) < 1.0 + WITHIN
        modes = [note["which"] for note in autopilot.notes("mode", since)]
        assert modes == (["POSCTL"] if dialect == "px4" else [])


def test_a_killed_guardian_is_replaced_and_the_flight_continues(tmp_path):
    async def script(flight, autopilot):
        await flight.cruise(autopilot)
        first = flight.vehicle.guardian.process
        os.kill(first, signal.SIGKILL)
        await flight.until(lambda: "guardian_lost" in flight.events, NORTH)
        await flight.run(2.0, NORTH)
        since = autopilot.now
        await flight.run(3.0, NORTH)
        assert flight.vehicle.guardian.process != first
        assert flight.vehicle.in_control
        assert autopilot.notes("setpoint", since)
        assert autopilot.notes("mode", since) == []
        await flight.land()

    over_the_wire(tmp_path, script)


def test_a_mission_that_was_overruled_flies_on_when_a_person_gives_control_back(tmp_path):
    async def script(flight, autopilot):
        await flight.cruise(autopilot)
        threading.Event().wait(7.0 / autopilot.speed)
        await flight.until(lambda: "failsafe_takeover" in flight.events, NORTH)
        assert not flight.vehicle.in_control
        since = autopilot.now
        await flight.until(lambda: autopilot.now > since + 2.0, NORTH)
        times, speeds = autopilot.speeds(since)
        assert max(speeds[times > since + 1.0]) < 0.5
        flight.vehicle.resume_control()
        await flight.until(lambda: autopilot.truth["velocity"][0] > 1.5, NORTH)

    over_the_wire(tmp_path, script, "ardupilot", guard=Patience(1.5, 3.0), speed=SLOW)


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_a_flight_that_breaks_off_ends_holding(dialect, tmp_path):
    async def leave(autopilot):
        async with flying(autopilot, tmp_path) as flight:
            await flight.cruise(autopilot)
            raise ZeroDivisionError

    with sitl(dialect) as autopilot:
        with pytest.raises(ZeroDivisionError):
            asyncio.run(leave(autopilot))
        since = autopilot.now
        until(lambda: autopilot.now > since + 3.0)
        assert autopilot.notes("setpoint", since) == []
        assert autopilot.truth["mode"] == {"px4": "LOITER", "ardupilot": "GUIDED"}[dialect]
        assert stopped_after(autopilot, since) < 1.5
