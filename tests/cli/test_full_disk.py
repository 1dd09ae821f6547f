"""A disk that is full, or a folder that has gone, changes nothing about how a flight goes."""

import errno
import json
import resource
import shutil
from contextlib import contextmanager

import pytest

from missionkit.recorder import checkpoint
from missionkit.recorder.mcap_channels import Channels

HOP = "runs/hop-seed0"


@contextmanager
def at_most(size):
    """Let no file grow beyond a size (bytes): the kernel refuses what is written behind it."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_a_rehearsal_flies_to_its_end_when_files_cannot_grow(call, hop):
    assert call("run", "hop.yaml").exit_code == 0  # compiles what has to be
    with at_most(20_000):
        result = call("run", "hop.yaml")
    assert result.exit_code == 0
    assert "success: flown as planned" in result.stdout
    printed = result.stderr.splitlines()
    parts = ("the journal", "the flight record", "checkpoints")
    assert [line.partition(": ")[0] for line in printed[:3]] == list(parts)
    assert all("File too large" in line for line in printed)
    assert [line.count("; the flight continues") for line in printed] == [1, 1, 1, 0]
    assert "track.png: " in printed[3]
    flown = json.loads((hop.parent / f"{HOP}-2" / "summary.json").read_text())
    assert flown["outcome"] == "success"
    assert flown["record_hash"] == ""
    assert len([it for it in flown["problems"] if "File too large" in it]) == len(parts)


def test_a_folder_that_is_removed_in_flight_is_named(call, hop, monkeypatch):
    save, count = checkpoint.Checkpoints.save, 0

    def last(self, *arguments):
        nonlocal count
        count += 1
        if count == 3:
            shutil.rmtree("runs")
        save(self, *arguments)

    monkeypatch.setattr(checkpoint.Checkpoints, "save", last)
    result = call("run", "hop.yaml")
    assert result.exit_code == 0
    assert result.stdout.startswith("  ")
    assert "success: flown as planned" in result.stdout
    removed = ("the flight record: it was removed", "the journal: it was removed")
    for what in (*removed, "checkpoints: No such file", "summary.json"):
        assert what in result.stderr


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EROFS, errno.EIO, errno.EACCES])
def test_the_live_view_and_the_track_show_failures_in_flight(call, hop, monkeypatch, code):
    flush, count = Channels.flush, 0

    def failing(self):
        nonlocal count
        count += 1
        if count > 30:
            raise OSError(code, "it does not work any more")
        flush(self)

    monkeypatch.setattr(Channels, "flush", failing)
    result = call("run", "hop.yaml")
    sentence = "the flight record: it does not work any more; the flight continues"
    assert (result.exit_code, result.stderr) == (0, sentence + "\n")
    assert f"problem: {sentence}" in result.stdout
    flown = json.loads((hop.parent / HOP / "summary.json").read_text())
    assert [it.partition(": ")[2] for it in flown["problems"]] == [sentence]
