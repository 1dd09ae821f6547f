"""A flight with a vehicle whose process is killed is resumed by another."""

import json
import subprocess

import pytest
from typer.testing import CliRunner
from vehicle.flying import arguments, command, sitl, until

from missionkit.cli.app import app

STAY = """
missionkit: 1
mission: stay
camera: {use: none}
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 2.5}
    transitions: [{to: up, when: done}]
  up:
    kind: custom
    transitions: [{to: land, after: 8}]
  land:
    kind: land
"""


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_a_killed_flight_is_resumed_and_ends_on_the_ground(dialect, tmp_path, monkeypatch):
    (tmp_path / "stay.yaml").write_text(STAY)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    folder = tmp_path / "runs" / "stay-vehicle"
    with sitl(dialect) as autopilot:
        if dialect == "px4":
            autopilot.ask(parameter="COM_OBL_RC_ACT", value=5)
            autopilot.patient(1.0)
        first = command(autopilot, "stay.yaml")
        with subprocess.Popen(first, cwd=tmp_path) as process:
            try:
                until(lambda: '"up"' in saved(folder))
            finally:
                process.kill()
        assert not autopilot.truth["on_ground"]
        done = CliRunner().invoke(app, arguments(autopilot, "--resume", str(folder)))
        truth = autopilot.truth
    assert done.exit_code == 0, done.output
    assert truth["on_ground"]
    assert not truth["armed"]
    written = json.loads((folder / "summary.json").read_text())
    assert [it["to"] for it in written["transitions"]] == ["up", "land"]
    assert not (folder / "checkpoint.json").exists()


def saved(folder):
    """Return the newest checkpoint; "" between two, when the one before has another name."""
    try:
        return (folder / "checkpoint.json").read_text()
    except FileNotFoundError:
        return ""
