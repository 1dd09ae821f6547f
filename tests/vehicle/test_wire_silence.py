"""Silence is safe: whatever happens to the process, the vehicle does not fly on.

Judged by the simulated autopilot's truth. It flies north at 2 m/s when the fault begins; times are
the vehicle's. PX4's own failsafe comes COM_OF_LOSS_T (1 s) after the last setpoint.
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
from vehicle.flying import NORTH, flying, sitl, until

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
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=env) as process:
        try:
            assert process.stdout.readline() == b"flying\n"
            until(lambda: autopilot.truth["velocity"][0] > 1.8)
            yield process
        finally:
            process.kill()


def test_a_loop_that_hangs_brakes_at_half_a_second_and_nothing_is_resumed(tmp_path):
    async def hang(autopilot):
        async with flying(autopilot, tmp_path) as flight:
            await flight.cruise(autopilot)
            autopilot.patient(1.0)
            since = autopilot.now
            threading.Event().wait(4.0 / autopilot.speed)  # in the loop's own thread
            await flight.run(3.0, NORTH)
            assert not flight.vehicle.in_control
            return since, flight

    with sitl() as autopilot:
        since, flight = asyncio.run(hang(autopilot))
        times, speeds = autopilot.speeds(since)
        setpoints = autopilot.notes("setpoint", since)
        modes = [note["which"] for note in autopilot.notes("mode", since)]
        assert stopped_after(autopilot, since) < 1.5
    assert speeds[np.searchsorted(times, since + 1.0)] < 1.0
    assert setpoints[-1]["at"] - since < 1.8
    assert modes == ["POSCTL"]
    assert "failsafe_takeover" in flight.events


@pytest.mark.parametrize("how", [signal.SIGSTOP, signal.SIGKILL, signal.SIGUSR1])
def test_a_process_that_stops_dies_or_stalls_ends_in_the_autopilots_failsafe(how, tmp_path):
    with sitl() as autopilot, client(autopilot, tmp_path) as process:
        autopilot.patient(1.0)
        since = autopilot.now
        process.send_signal(how)
        until(lambda: autopilot.now > since + 2.0)
        process.send_signal(signal.SIGCONT)
        until(lambda: autopilot.now > since + 4.0)
        left = autopilot.notes("mode", since)
        assert left[0]["which"] == "POSCTL"
        assert left[0]["at"] - since < 1.3
        assert stopped_after(autopilot, since) < 2.6
        assert len(left) == 1
        assert all(note["at"] < since + 0.5 for note in autopilot.notes("setpoint", since))


def test_a_storm_of_garbage_collections_ends_in_the_autopilots_failsafe(tmp_path):
    with sitl() as autopilot, client(autopilot, tmp_path) as process:
        autopilot.patient(1.0)
        since = autopilot.now
        process.send_signal(signal.SIGUSR2)
        until(lambda: autopilot.now > since + 5.0)
        left = [note["which"] for note in autopilot.notes("mode", since)]
        assert left == ["POSCTL"]
        assert stopped_after(autopilot, since) < 3.0


def test_ardupilot_stops_by_itself_when_the_client_is_killed(tmp_path):
    with sitl("ardupilot") as autopilot, client(autopilot, tmp_path) as process:
        autopilot.ask(parameter="GUID_TIMEOUT", value=0.5)
        since = autopilot.now
        process.kill()
        until(lambda: autopilot.now > since + 4.0)
        assert stopped_after(autopilot, since) < 2.0


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
