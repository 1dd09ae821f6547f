"""A free flyer whose process is killed resumes and docks."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from missionkit.cli import run_in_simulator as command

MISSIONS = Path(__file__).parents[2] / "missions"
START = "[0.6, 1.2, 0.6]"


class KilledError(BaseException):
    """Stands for SIGKILL: nothing of the command's own runs after it."""


@pytest.fixture
def killed(call, tmp_path, monkeypatch):
    """Fly from near the target until a moment, then die; return the folder."""
    shutil.copy(MISSIONS / "docking.yaml", tmp_path)
    (tmp_path / "worlds").mkdir()
    world = (MISSIONS / "worlds" / "docking.yaml").read_text()
    world = world.replace("position: [0, 1, 0]", f"position: {START}")
    (tmp_path / "worlds" / "docking.yaml").write_text(world)
    save = command.RehearsalCheckpointWriter.__call__

    def last(self, kept):
        save(self, kept)
        if kept.course.memory.now >= 10.0 - 1e-6:
            raise KilledError

    monkeypatch.setattr(command.RehearsalCheckpointWriter, "__call__", last)
    with pytest.raises(KilledError):
        call("run", "docking.yaml", "--set", f"start={START}")
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    return Path("runs/docking-seed0")


def test_it_drifts_while_nobody_commands_and_docks_all_the_same(call, killed):
    result = call("run", "--resume", str(killed), "--gap", "2")
    assert (result.exit_code, result.stderr) == (0, "")
    assert "in direct; the chart continues" in result.stdout
    assert "success: flown as planned" in result.stdout
    assert "landed" not in result.stdout
    summary = json.loads((killed / "summary.json").read_text())
    assert [it["to"] for it in summary["transitions"]] == ["direct", "dock", "docked", "land"]
    assert summary["outcome"] == "success"
