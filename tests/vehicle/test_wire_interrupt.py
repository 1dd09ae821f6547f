"""Signals in flight: the first one lands, a second one stops the program.

Which signals do is tested with the simulator, in `engine/test_flight_loop.py`.
"""

import os
import signal
import subprocess
import threading
from contextlib import contextmanager

from child import default_signals
from vehicle.flying import command, sitl, until
from vehicle.on_a_mission import AHEAD, stay

from missionkit.api.interrupts import SAME_KEYPRESS

PATIENCE = 90.0  # s, wall


@contextmanager
def program(autopilot, tmp_path):
    """Run `missionkit run --vehicle` until it flies north."""
    (tmp_path / "stay.yaml").write_text(stay(AHEAD))
    env = {**os.environ, "XDG_RUNTIME_DIR": str(tmp_path)}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    pipes["preexec_fn"] = default_signals
    words = command(autopilot, "stay.yaml")
    with subprocess.Popen(words, cwd=tmp_path, env=env, **pipes) as process:
        try:
            until(lambda: autopilot.truth["velocity"][0] > 1.5, PATIENCE)
            yield process
        finally:
            process.kill()


def test_the_first_one_lands(tmp_path):
    with sitl() as autopilot, program(autopilot, tmp_path) as process:
        since = autopilot.now
        process.send_signal(signal.SIGTERM)
        process.send_signal(signal.SIGHUP)  # as service managers do at once: counts as one
        text, _ = process.communicate(timeout=PATIENCE)
        assert process.returncode == 1, text
        (mode,) = autopilot.notes("mode", since)
        truth = autopilot.truth
    assert mode["which"] == "LAND"
    assert mode["at"] - since < 3.0
    assert truth["on_ground"]
    assert not truth["armed"]
    assert not truth["crashed"]


def test_the_second_one_stops_the_program_and_leaves_the_vehicle_holding(tmp_path):
    with sitl() as autopilot, program(autopilot, tmp_path) as process:
        autopilot.ask(fault="command_denied=21")
        since = autopilot.now
        process.send_signal(signal.SIGINT)
        until(lambda: "21" in {it["which"][:2] for it in autopilot.notes("command", since)})
        assert process.poll() is None
        threading.Event().wait(2.0 * SAME_KEYPRESS)
        process.send_signal(signal.SIGINT)
        text, _ = process.communicate(timeout=PATIENCE)
        assert process.returncode == 3, text
        assert "stopped before it had landed" in text
        end = autopilot.now
        until(lambda: autopilot.now > end + 2.0)
        assert autopilot.notes("setpoint", end) == []
        assert autopilot.truth["mode"] == "LOITER"
        assert max(autopilot.speeds(end + 1.0)[1]) < 0.5
        assert not autopilot.truth["on_ground"]
