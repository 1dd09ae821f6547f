"""A run whose process is killed resumes from where it was; changes to the mission are named."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import missionkit
from missionkit.api.run_origin import found_origin, keep_origin
from missionkit.cli import run_in_simulator as command
from missionkit.recorder import checkpoint
from missionkit.recorder.checkpoint import BEFORE_NEWEST, NEWEST, load
from missionkit.recorder.record_reader import read
from missionkit.recorder.run_folder import held
from missionkit.rehearsal.rehearse import Kept

STAY = """\
missionkit: 1
mission: stay
params: {height: 2.0, stay: 6}
camera: {use: none}
world: field.yaml
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: $height}
    transitions: [{to: up, when: done}]
  up:
    kind: custom
    transitions: [{to: land, after: $stay}]
  land:
    kind: land
"""
FIELD = "world: field\nwind: {mean: [1.0, 0.5, 0.0]}\n"


class KilledError(BaseException):
    """Stands for SIGKILL: nothing of the command's own runs after it."""


@pytest.fixture
def stay(call, tmp_path):
    path = tmp_path / "stay.yaml"
    path.write_text(STAY)
    (tmp_path / "field.yaml").write_text(FIELD)
    return path


@pytest.fixture(scope="module")
def remains():
    """Files of runs that were killed, by what was flown until when."""
    return {}


@pytest.fixture
def killed(call, stay, tmp_path, monkeypatch, remains):
    """Fly until a moment, then die; return the folder. The same flight is flown once."""
    folder = Path("runs/stay-seed0")

    def found(at=5.0, *arguments):
        flight = (at, arguments, *(path.read_text() for path in sorted(tmp_path.glob("*.*"))))
        if flight not in remains:
            fly(at, *arguments)
            origin = found_origin(folder)
            remains[flight] = (
                {it.name: it.read_bytes() for it in folder.iterdir()},
                origin,
                tmp_path,
            )
            return folder
        files, origin, there = remains[flight]
        folder.mkdir(parents=True)
        for name, data in files.items():
            (folder / name).write_bytes(data)
        moved = [it.replace(str(there), str(tmp_path)) for it in origin.plugins]
        mission = origin.mission.replace(str(there), str(tmp_path))
        keep_origin(folder, origin._replace(mission=mission, plugins=tuple(moved)))
        return folder

    def fly(at, *arguments):
        save = command.RehearsalCheckpointWriter.__call__

        def last(self, kept: Kept):
            save(self, kept)
            if kept.course.memory.now >= at - 1e-6:
                raise KilledError

        monkeypatch.setattr(command.RehearsalCheckpointWriter, "__call__", last)
        with pytest.raises(KilledError):
            call("run", "stay.yaml", *arguments)
        monkeypatch.undo()
        monkeypatch.chdir(tmp_path)

    return found


def summary(folder):
    return json.loads((folder / "summary.json").read_text())


def entered(folder, state):
    return next(it["at"] for it in summary(folder)["transitions"] if it["to"] == state)


def test_a_killed_run_continues_and_is_summarised_as_a_whole(call, killed):
    folder = killed()
    saved = load(folder).value.kept.course.memory
    result = call("run", "--resume", str(folder))
    assert (result.exit_code, result.stderr) == (0, "")
    assert "resumed after 2.95 s: in the air, in up; the chart continues" in result.stdout
    assert result.stdout.count("  up: ") == 1  # the live view does not catch up with the past
    written = summary(folder)
    assert [it["to"] for it in written["transitions"]] == ["up", "land"]
    assert [it["state"] for it in written["states"]] == ["idle", "up", "land"]
    assert written["duration"] > saved.now + 3.0
    assert (written["grade"]["landed"], written["seed"]) == (True, 0)
    assert {path.name for path in folder.iterdir()} == {
        *("flight.mcap", "flight-2.mcap", "mission.yaml", "summary.json", "track.png"),
        *("journal.mcap", "journal-2.mcap"),
    }
    again = next(read(folder / "flight-2.mcap", "/command"))
    assert saved.now + 2.7 < again.at < saved.now + 3.2  # nothing was commanded before
    killed_part, rest = missionkit.replay(folder)
    assert (killed_part.difference, rest.difference) == (None, None)
    assert killed_part.until < again.at <= rest.since < again.at + 0.1
    assert rest.until == pytest.approx(written["duration"], abs=0.1)


@pytest.mark.parametrize("gap", [0.0, 1.0, 1.8])
def test_timers_go_on_in_mission_time(call, killed, gap):
    folder = killed()
    call("run", "--resume", str(folder), "--gap", str(gap))
    assert entered(folder, "land") - entered(folder, "up") == pytest.approx(6.0, abs=0.06)


def test_a_timer_that_ran_out_meanwhile_acts_at_once(call, killed):
    folder = killed(5.0)
    call("run", "--resume", str(folder), "--gap", "8")
    commands = read(folder / "flight-2.mcap", "/command")
    assert entered(folder, "land") == pytest.approx(next(commands).at)


def test_a_run_may_be_killed_twice(call, killed, monkeypatch):
    folder = killed(4.0)
    save = command.RehearsalCheckpointWriter.__call__

    def last(self, kept):
        save(self, kept)
        if kept.course.memory.now >= 7.0:
            raise KilledError

    with monkeypatch.context() as patch:
        patch.setattr(command.RehearsalCheckpointWriter, "__call__", last)
        with pytest.raises(KilledError):
            call("run", "--resume", str(folder))
    assert call("run", "--resume", str(folder)).exit_code == 0
    assert (folder / "flight-3.mcap").is_file()
    assert [it["to"] for it in summary(folder)["transitions"]] == ["up", "land"]


def test_a_damaged_checkpoint_is_reported_and_the_previous_one_used(call, killed):
    folder = killed()
    text = (folder / NEWEST).read_text()
    (folder / NEWEST).write_text(text[:-100])
    result = call("run", "--resume", str(folder))
    assert result.exit_code == 0
    assert "this checkpoint cannot be used: it was truncated or changed" in result.stderr


def test_without_a_sound_checkpoint_nothing_is_flown(call, killed):
    folder = killed()
    (folder / NEWEST).write_text("")
    (folder / BEFORE_NEWEST).unlink()
    result = call("run", "--resume", str(folder))
    assert result.exit_code == 2
    assert result.stderr == f"{folder / NEWEST}: this checkpoint cannot be used: " + (
        "this is not a checkpoint of this missionkit\n"
    )
    assert not (folder / "flight-2.mcap").exists()


def test_a_checkpoint_that_holds_something_else_is_refused(call, killed):
    folder = killed()
    (folder / NEWEST).write_text(checkpoint.sealed(checkpoint.Saved((1, 2), {})))
    result = call("run", "--resume", str(folder))
    assert (result.exit_code, result.stderr) == (
        2,
        f"{folder / NEWEST}: this is not the checkpoint of a flight\n",
    )


def test_a_pipe_in_place_of_a_checkpoint_is_not_waited_for(call, killed):
    folder = killed()
    (folder / BEFORE_NEWEST).unlink()
    (folder / "checkpoint-ticks.rows").unlink()
    os.mkfifo(folder / "checkpoint-ticks.rows")
    os.mkfifo(folder / BEFORE_NEWEST)
    result = call("run", "--resume", str(folder))
    assert result.exit_code == 2
    assert result.stderr.count("it is a pipe, not a file") == 2


@pytest.mark.parametrize("odd", [{"seed": -1}, {"mission": None}, {"faults": 5}, {"texts": "x"}])
def test_an_origin_that_describes_no_run_is_refused(call, killed, odd):
    folder = killed()
    keep_origin(folder, found_origin(folder)._replace(**odd))
    result = call("run", "--resume", str(folder))
    says = f"{folder / 'origin.json'}: cannot be used: it does not describe a run\n"
    assert (result.exit_code, result.stderr) == (2, says)


@pytest.mark.parametrize(
    ("name", "old", "new", "lines"),
    [
        (
            "stay.yaml",
            "kind: custom",
            "kind: hover",
            ["--- stay.yaml (as flown)", "+++ stay.yaml (now)", "-    kind: custom"],
        ),
        (
            "field.yaml",
            "0.5",
            "0.6",
            ["--- field.yaml (as flown)", "+wind: {mean: [1.0, 0.6, 0.0]}"],
        ),
        (
            "stay.yaml",
            "stay: 6",
            "stay: 7",
            ["+params: {height: 2.0, stay: 7}", "parameter stay: 6 as flown, 7 now"],
        ),
    ],
)
def test_a_changed_file_is_refused_with_its_differences(
    call, killed, tmp_path, name, old, new, lines
):
    folder = killed()
    path = tmp_path / name
    path.write_text(path.read_text().replace(old, new))
    result = call("run", "--resume", str(folder))
    assert result.exit_code == 2
    said = result.stderr.splitlines()
    assert said[0] == (
        f"{folder}: the mission has changed since; --force resumes with it as it is now"
    )
    assert set(lines) <= set(said)
    assert (folder / NEWEST).is_file()
    forced = call("run", "--resume", str(folder), "--force")
    assert forced.exit_code == 0
    assert "guards, behaviours and histories restart" in forced.stdout
    assert (folder / "mission-2.yaml").read_bytes() == (tmp_path / "stay.yaml").read_bytes()


@pytest.mark.parametrize("vehicle", [(), ("--vehicle", "udpin://127.0.0.1:14999")])
def test_a_changed_mission_is_refused_before_anything_is_compiled(
    call, killed, stay, monkeypatch, vehicle
):
    folder = killed()
    stay.write_text(STAY.replace("stay: 6", "stay: 7"))

    def compiling(*_, **__):
        raise AssertionError

    monkeypatch.setattr("missionkit.sim.simulators.warm_up_multicopter", compiling)
    monkeypatch.setattr("missionkit.engine.prepared_mission.warm_up", compiling)
    result = call("run", "--resume", str(folder), *vehicle)
    assert result.exit_code == 2
    assert "the mission has changed since" in result.stderr


def test_a_changed_mission_killed_right_after_resuming_is_still_changed(
    call, killed, stay, monkeypatch
):
    folder = killed()
    text = STAY.replace(
        "after: $stay}", "when: {use: near_goal, radius: 1}}, {to: land, after: $stay}"
    )
    stay.write_text(text)

    def die(*_, **__):
        raise KilledError

    with monkeypatch.context() as patch:
        patch.setattr(command, "rehearse", die)
        with pytest.raises(KilledError):
            call("run", "--resume", str(folder), "--force")
    result = call("run", "--resume", str(folder))
    assert result.exit_code == 0
    assert "guards, behaviours and histories restart" in result.stdout


def test_another_value_of_a_parameter_is_a_change(call, killed):
    folder = killed(5.0, "--set", "stay=8")
    result = call("run", "--resume", str(folder), "--set", "stay=9")
    assert result.exit_code == 2
    assert result.stderr.splitlines()[1:] == ["parameter stay: 8 as flown, 9 now"]
    assert call("run", "--resume", str(folder)).exit_code == 0
    assert entered(folder, "land") - entered(folder, "up") == pytest.approx(8.0, abs=0.06)


def test_other_targets_are_refused_also_by_force(call, killed, stay):
    folder = killed()
    stay.write_text(STAY + "targets: {pole: {position: [9, 0, -2]}}\n")
    result = call("run", "--resume", str(folder), "--force")
    assert result.exit_code == 2
    assert "the targets differ from those of the run" in result.stderr


def test_a_missing_state_lands(call, killed, stay):
    folder = killed()
    stay.write_text(STAY.replace("  up:", "  aloft:").replace("to: up", "to: aloft"))
    result = call("run", "--resume", str(folder), "--force")
    assert result.exit_code == 0
    assert "in the air, in a state that the chart no longer has; landing" in result.stdout
    assert summary(folder)["transitions"][-1]["reason"] == "operator: land"


def test_a_flight_that_has_ended_is_not_resumed(call, stay):
    call("run", "stay.yaml")
    result = call("run", "--resume", "runs/stay-seed0")
    assert (result.exit_code, result.stderr) == (
        2,
        "runs/stay-seed0: nothing to resume: the flight has ended\n",
    )


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ([], "name the mission file to fly, or --resume RUN"),
        (["--resume", "nowhere"], "nowhere: nothing to resume: it holds no origin.json"),
    ],
)
def test_a_command_that_names_no_flight_is_refused(call, arguments, says):
    result = call("run", *arguments)
    assert (result.exit_code, result.stderr) == (2, says + "\n")


def test_faults_cannot_be_changed(call, killed):
    result = call("run", "--resume", str(killed()), "--fault", "gnss_lost")
    assert (result.exit_code, result.stderr) == (2, "--fault cannot be changed by --resume\n")


FOREIGN = """\
from typing import Any, ClassVar

from missionkit.messages import Estimate, Step, Verdict
from missionkit.plugin import Behavior, WindowGuard


class Count:
    def __init__(self, ticks: int) -> None:
        self.ticks = ticks


class Stare(Behavior):
    kind: ClassVar[str] = "stare"

    def begin(self, seen: Estimate) -> Count:
        return Count(0)

    def step(self, seen: Estimate, memory: Any) -> Step:
        return Step(memory=Count(memory.ticks + 1), note=f"stared {memory.ticks}")


class Patient(WindowGuard):
    kind: ClassVar[str] = "patient"

    def begin(self) -> Count:
        return Count(0)

    def advance(self, memory: Any, seen: Estimate) -> Count:
        return Count(memory.ticks + 1)

    def check(self, memory: Any, seen: Estimate) -> Verdict:
        return Verdict.at_least(float(memory.ticks), 1e6)
"""


def test_a_foreign_plug_ins_unsaved_memory_restarts_and_is_reported(call, killed, stay, tmp_path):
    (tmp_path / "mine.py").write_text(FOREIGN)
    up = "behavior: {use: stare}\n    transitions: [{to: land, when: {use: patient}}, "
    stay.write_text(STAY.replace("transitions: [{to: land, after", f"{up}{{to: land, after"))
    folder = killed(5.0, "--plugin", "mine.py")
    result = call("run", "--resume", str(folder), "--plugin", "mine.py")
    assert (result.exit_code, result.stderr) == (0, "")
    assert "the memory of stare in up cannot be saved: it will restart on resume" in result.stdout
    assert "the memory of patient cannot be saved: it will restart on resume" in result.stdout
    notes = [entry.data["note"] for entry in read(folder / "flight-2.mcap", "/state")]
    assert notes[0] == "stared 0"


PLANTED = """\
from pathlib import Path

Path("was_run").touch()
"""


def test_a_plug_in_that_only_the_folder_names_is_never_run(call, killed, stay, tmp_path):
    (tmp_path / "mine.py").write_text(FOREIGN)
    folder = killed(5.0, "--plugin", "mine.py")
    (tmp_path / "mine.py").write_text(PLANTED)
    result = call("run", "--resume", str(folder))
    assert (result.exit_code, result.stderr) == (
        2,
        f"{folder}: this run used plug-in files, which --resume does not run by itself; "
        f"review them and name them yourself: --plugin {tmp_path / 'mine.py'}\n",
    )
    assert not (tmp_path / "was_run").exists()


def test_a_plug_in_that_was_changed_is_refused_before_it_is_run(call, killed, tmp_path):
    (tmp_path / "mine.py").write_text(FOREIGN)
    folder = killed(5.0, "--plugin", "mine.py")
    (tmp_path / "mine.py").write_text(PLANTED + FOREIGN)
    result = call("run", "--resume", str(folder), "--plugin", "mine.py")
    assert result.exit_code == 2
    assert result.stderr.startswith(f"{folder}: a plug-in differs from the one flown\n--- mine.py")
    assert not (tmp_path / "was_run").exists()
    forced = call("run", "--resume", str(folder), "--plugin", "mine.py", "--force")
    assert forced.exit_code == 0


SUICIDE = """\
import os, signal
from missionkit.engine import flight_loop

ticks, tick = 0, flight_loop.tick


def last(*arguments):
    global ticks
    ticks += 1
    if ticks == {tick}:
        os.kill(os.getpid(), signal.SIGKILL)
    return tick(*arguments)


flight_loop.tick = last
from missionkit.cli.app import app

app(["run", "stay.yaml", "--headless"])
"""


@pytest.mark.parametrize("tick", [3, 160])
def test_the_record_of_a_killed_flight_reaches_to_the_tick_before(stay, tmp_path, tick):
    code = SUICIDE.format(tick=tick)
    done = subprocess.run([sys.executable, "-c", code], check=False, capture_output=True)
    assert done.returncode == -signal.SIGKILL, done.stderr
    poses = [entry.at for entry in read(tmp_path / "runs/stay-seed0/flight.mcap", "/pose")]
    assert poses == pytest.approx([0.05 * number for number in range(1, tick)])


def test_one_flight_cannot_be_resumed_twice(call, killed):
    folder = killed()
    with held(folder):
        result = call("run", "--resume", str(folder))
    assert (result.exit_code, result.stderr) == (
        2,
        f"{folder}: another missionkit is flying this run; wait for it, or stop it first\n",
    )
    assert call("run", "--resume", str(folder)).exit_code == 0


def test_a_running_flight_cannot_be_resumed_by_another_process(call, stay, monkeypatch):
    inner = []
    save = command.RehearsalCheckpointWriter.__call__

    def meanwhile(self, kept):
        save(self, kept)
        if not inner:
            inner.append(call("run", "--resume", "runs/stay-seed0"))

    monkeypatch.setattr(command.RehearsalCheckpointWriter, "__call__", meanwhile)
    assert call("run", "stay.yaml").exit_code == 0
    assert inner[0].exit_code == 2
    assert "another missionkit is flying this run" in inner[0].stderr


def test_a_killed_process_leaves_a_resumable_run(call, stay, tmp_path):
    line = [sys.executable, "-m", "missionkit", "run"]
    with subprocess.Popen([*line, "stay.yaml", "--speed", "5"], stdout=-1, text=True) as process:
        while "idle -> up" not in process.stdout.readline():
            assert process.poll() is None
        process.send_signal(signal.SIGKILL)
    assert process.returncode == -signal.SIGKILL
    folder = tmp_path / "runs/stay-seed0"
    assert not (folder / "summary.json").exists()
    done = call("run", "--resume", str(folder))
    assert (done.exit_code, done.stderr) == (0, "")
    assert summary(folder)["outcome"] == "success"
