"""`missionkit run --sitl`: one command starts an autopilot, flies it and ends it."""

import os
import subprocess
import sys

import pytest
from samples import HOP
from typer.testing import CliRunner
from vehicle.flying import affordable, until

from missionkit.api.missions import assemble
from missionkit.chart.load import parse
from missionkit.cli.app import app
from missionkit.cli.simulated_autopilot import simulated_autopilot
from missionkit.errors import UsageError

ORIGIN = "origin: {lat: -33.9, lon: 179.995, alt: -20.5}\n"
MISSION = f"{HOP}{ORIGIN}"


def children():
    """Return the processes that simulate an autopilot for this one or its children."""
    found = subprocess.run(
        ["ps", "-ww", "-eo", "pid,args"], capture_output=True, text=True, check=True
    )
    rows = [row.split(None, 1) for row in found.stdout.splitlines()]
    return {int(pid) for pid, args in rows[1:] if "--tied" in args and MARK in args}


MARK = f"--seed {os.getpid()}"
SEED = str(os.getpid())


def test_a_hop_is_flown_and_nothing_is_left(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    (tmp_path / "hop.yaml").write_text(MISSION)
    words = ["run", str(tmp_path / "hop.yaml"), "--sitl", "ardupilot", "--headless"]
    speed = str(affordable(6.0))
    more = ["--seed", SEED, "--speed", speed, "--out", str(tmp_path / "runs")]
    flown = CliRunner().invoke(app, [*words, *more])
    assert flown.exit_code == 0, flown.output
    assert not children()


HELD = """
import pathlib, sys
from missionkit.api.missions import assemble
from missionkit.chart.load import load
from missionkit.cli.simulated_autopilot import simulated_autopilot
path = pathlib.Path("hop.yaml")
with simulated_autopilot("px4", load(path, assemble(())), path.parent, seed=int(sys.argv[1])):
    sys.stdin.read()
"""


def test_the_autopilot_is_no_child_of_the_terminal_and_ends_with_the_program(tmp_path):
    (tmp_path / "hop.yaml").write_text(MISSION)
    words = [sys.executable, "-c", HELD, SEED]
    with subprocess.Popen(words, cwd=tmp_path, stdin=subprocess.PIPE) as process:
        until(children)
        (autopilot,) = children()
        assert os.getsid(autopilot) == autopilot
        process.kill()
    until(lambda: not children())


def test_what_does_not_fit_is_one_sentence(tmp_path):
    mission = parse(MISSION, "hop.yaml", assemble(()))
    with pytest.raises(UsageError, match="--sitl gazebo: must be one of px4, ardupilot"):
        simulated_autopilot("gazebo", mission, tmp_path).__enter__()
    with pytest.raises(UsageError, match=r"the simulated autopilot: .*'hail'"):
        simulated_autopilot("px4", mission, tmp_path, faults=("hail",)).__enter__()
    (tmp_path / "hop.yaml").write_text(MISSION)
    words = ["run", str(tmp_path / "hop.yaml"), "--sitl", "px4", "--vehicle", "udpin://127.0.0.1:9"]
    refused = CliRunner().invoke(app, words)
    assert refused.exit_code == 2
    assert "leave out --vehicle" in refused.output
