from __future__ import annotations

import json
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from child import default_signals

from missionkit.api.interrupts import SAME_KEYPRESS
from missionkit.cli import main, run_output
from missionkit.cli import run_in_simulator as command
from missionkit.errors import VehicleError
from missionkit.recorder.record_reader import read

FILES = {"flight.mcap", "journal.mcap", "mission.yaml", "summary.json", "track.png"}


def summary(folder):
    return json.loads((folder / "summary.json").read_text())


def test_a_run_says_how_it_went_and_leaves_one_folder(call, tmp_path):
    result = call("run", "hop.yaml", "--seed", "3")
    assert (result.exit_code, result.stderr) == (0, "")
    *lines, verdict, folder = result.stdout.splitlines()
    assert lines[0].split()[:3] == ["0.1", "s", "idle"]
    assert any("idle -> land: when done" in line for line in lines)
    assert verdict.startswith("success: flown as planned, ")
    assert folder == "runs/hop-seed3"
    made = {path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file()}
    assert made == {Path("hop.yaml")} | {Path(folder) / name for name in FILES}
    assert summary(tmp_path / folder)["outcome"] == "success"


def test_without_a_live_view_a_run_still_says_what_the_mission_logs(call, hop):
    text = hop.read_text().replace(
        "{to: land, when: done}", "{to: land, when: done, do: [{log: up}]}"
    )
    hop.write_text(text)
    result = call("run", "hop.yaml", "--headless")
    at, _, line = result.stdout.splitlines()[0].strip().partition(" s  ")
    assert float(at) > 1.0
    assert line == "log: up"
    assert len(result.stdout.splitlines()) == 3
    assert "log: up" not in call("run", "hop.yaml", "--json", "--out", "again").stdout


def test_a_run_for_programs(call, tmp_path):
    result = call("run", "hop.yaml", "--json", "--set", "height=3", "--out", "here")
    printed = json.loads(result.stdout)
    assert printed.pop("folder") == "here/hop-seed0"
    assert printed == summary(tmp_path / "here/hop-seed0")
    assert (printed["outcome"], printed["parameters"], printed["seed"]) == (
        "success",
        {"height": 3},
        0,
    )


@pytest.mark.parametrize(
    ("change", "arguments", "code", "reason"),
    [
        ("settings: {time_limit: 3}\n", [], 1, "landed because time ran out"),
        ("settings: {time_limit: 1}\n", [], 1, "the vehicle never took off"),
        ("success: {visit: out}\n", [], 1, "landed without reaching out"),
        ("success: {visit: land, target: pole}\n", [], 1, "no marker of pole in the world"),
        ("", ["--fault", "battery_sag=1@4"], 3, "hit an obstacle or the ground"),
    ],
)
def test_a_run_without_success_says_why(call, hop, change, arguments, code, reason):
    out = "  out: {kind: hover, transitions: [{to: land, after: 5}]}\n"
    targets = "targets:\n  pole: {position: [9, 0, -2]}\n"
    targets += "perception: [{use: aruco, target: pole, id: 5, size: 0.4}]\n"
    ways = "{to: land, when: done}"
    text = hop.read_text().replace(ways, f"{ways}, {{to: out, event: go}}")
    hop.write_text(text + out + targets + change)
    result = call("run", "hop.yaml", "--headless", *arguments)
    assert result.exit_code == code
    assert reason in result.stdout
    conditions = "success" in change
    assert len(result.stdout.splitlines()) == 2 + conditions


def test_a_crash_keeps_the_record_and_says_where(call, tmp_path, monkeypatch):
    def crash(*_, **__):
        raise ZeroDivisionError("ours")

    monkeypatch.setattr(command, "rehearse", crash)
    result = call("run", "hop.yaml")
    assert result.exit_code == 4
    assert result.stderr == "missionkit crashed; see runs/hop-seed0/crash.txt\n"
    folder = tmp_path / "runs/hop-seed0"
    assert "ZeroDivisionError: ours" in (folder / "crash.txt").read_text()
    assert (folder / "flight.mcap").is_file()


def test_ctrl_c_after_the_landing_leaves_out_the_picture_and_nothing_else(call, monkeypatch):
    def slow(*_, **__):
        signal.raise_signal(signal.SIGTERM)  # the first one is answered by a landing
        threading.Event().wait(1.1 * SAME_KEYPRESS)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(run_output, "draw", slow)
    result = call("run", "hop.yaml", "--headless")
    folder = Path("runs/hop-seed0")
    assert (result.exit_code, result.stderr) == (0, f"{folder / 'track.png'}: interrupted\n")
    assert summary(folder)["outcome"] == "success"


def test_ctrl_c_before_a_command_begins_leaves_no_traceback(monkeypatch, capfd):
    def interrupt():
        raise KeyboardInterrupt

    monkeypatch.setattr("missionkit.cli.app.app", interrupt)
    with pytest.raises(SystemExit, match="130"):
        main()
    assert capfd.readouterr() == ("", "")


def test_an_unreachable_vehicle_is_not_a_crash(call, monkeypatch):
    def silent(*_, **__):
        raise VehicleError("no heartbeat from udp:14540 in 10 s")

    monkeypatch.setattr(command, "rehearse", silent)
    result = call("run", "hop.yaml")
    assert (result.exit_code, result.stderr) == (3, "no heartbeat from udp:14540 in 10 s\n")


@pytest.fixture
def interrupted(hop):
    """Fly in a process of its own, with a Ctrl-C whenever the next of some words is said."""

    def fly(*words, speed=10):
        line = [sys.executable, "-m", "missionkit", "run", str(hop), "--speed", str(speed)]
        line += ["--set", "height=30", "--out", str(hop.parent / "runs")]
        pipes = {"stdout": -1, "stderr": -1, "text": True, "preexec_fn": default_signals}
        with subprocess.Popen(line, **pipes) as process:
            for number, word in enumerate(words):
                while word not in (said := process.stdout.readline()) and said:
                    pass
                threading.Event().wait(2.0 * SAME_KEYPRESS if number else 0.0)
                process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=60)
        return process.returncode, out, err, hop.parent / "runs/hop-seed0"

    return fly


def states(folder):
    return [entry.data["state"] for entry in read(folder / "flight.mcap", "/state")]


def test_ctrl_c_lands(interrupted):
    code, out, err, folder = interrupted("climbing")
    assert (code, err) == (1, "")
    assert "ended safely: landed because the operator requested it" in out
    printed = summary(folder)
    assert printed["transitions"][-1]["reason"] == "operator: land"
    assert printed["grade"]["landed"]
    assert printed["duration"] > 7.0
    assert states(folder)[-1] == "land"
    assert {path.name for path in folder.iterdir()} == FILES


def test_a_second_ctrl_c_stops_and_keeps_the_record(interrupted):
    code, out, err, folder = interrupted("climbing", "operator: land", speed=1)  # not down yet
    assert code == 3
    assert "ended" not in out
    assert err == f"stopped before it had landed; see {folder}\n"
    assert states(folder)[-1] == "land"
