"""A disk that is full, slow or gone while a vehicle is in the air: it flies on and lands."""

import errno
import json
import shutil
import threading

from typer.testing import CliRunner
from vehicle.flying import sitl
from vehicle.on_a_mission import stay

from missionkit.cli.app import app
from missionkit.recorder import checkpoint
from missionkit.recorder.mcap_channels import Channels
from missionkit.recorder.record_reader import read

SPEED = 2.0  # a busy machine keeps up with it: a clock that lags is a problem of its own


def flown(dialect, folder, monkeypatch):
    """Fly a short mission from the command line; return the result and the truth at its end."""
    (folder / "stay.yaml").write_text(stay(after=2.0))
    monkeypatch.chdir(folder)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(folder))
    with sitl(dialect, SPEED) as autopilot:
        line = ("run", "stay.yaml", "--vehicle", autopilot.url, "--speed", str(autopilot.speed))
        result = CliRunner().invoke(app, [*line, "--headless"])
        truth = autopilot.truth
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result, truth


def test_a_full_disk_in_the_air_is_named_and_the_vehicle_lands(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    flush = Channels.flush

    def filling(self):
        flush(self)
        if (tmp_path / "runs/stay-vehicle/checkpoint-before.json").exists():  # it flies
            monkeypatch.setattr(checkpoint.os, "fsync", full)
            full()

    monkeypatch.setattr(Channels, "flush", filling)
    result, truth = flown("px4", tmp_path, monkeypatch)
    assert result.exit_code == 0, result.output
    assert (truth["on_ground"], truth["armed"]) == (True, False)
    for what in ("the flight record", "checkpoints"):
        assert f"{what}: No space left on device; the flight continues" in result.stderr


def test_a_folder_that_is_removed_in_the_air_is_named_and_the_vehicle_lands(tmp_path, monkeypatch):
    flush = Channels.flush

    def removing(self):
        if (tmp_path / "runs/stay-vehicle/checkpoint-before.json").exists():
            shutil.rmtree(tmp_path / "runs")
        flush(self)

    monkeypatch.setattr(Channels, "flush", removing)
    result, truth = flown("ardupilot", tmp_path, monkeypatch)
    assert result.exit_code == 0, result.output
    assert (truth["on_ground"], truth["armed"]) == (True, False)
    assert "the flight record: it was removed while being written" in result.stderr
    assert "summary.json: No such file or directory" in result.stderr


def test_a_slow_disk_is_waited_for_by_no_tick(tmp_path, monkeypatch):
    """Nothing that waits for the disk runs on the thread that commands."""
    sync, write = checkpoint.os.fsync, Channels.flush
    threads = []

    def slow(number):
        threads.append(threading.current_thread())
        threading.Event().wait(0.7)
        sync(number)

    def noted(self):
        threads.append(threading.current_thread())
        write(self)

    keep = checkpoint.Checkpoints.save

    def keeping(self, *arguments):
        with monkeypatch.context() as patch:
            patch.setattr(checkpoint.os, "fsync", slow)
            keep(self, *arguments)

    monkeypatch.setattr(checkpoint.Checkpoints, "save", keeping)
    monkeypatch.setattr(Channels, "flush", noted)
    result, truth = flown("px4", tmp_path, monkeypatch)
    assert (result.exit_code, result.stderr) == (0, ""), result.output
    assert truth["on_ground"]
    assert threading.main_thread() not in threads
    assert len(set(threads)) == 2
    folder = tmp_path / "runs/stay-vehicle"
    assert not list(folder.glob("checkpoint*"))
    written = json.loads((folder / "summary.json").read_text())
    poses = [entry.at for entry in read(folder / "flight.mcap", "/pose")]
    assert written["problems"] == []
    assert len(poses) == written["timing"]["ticks"]
