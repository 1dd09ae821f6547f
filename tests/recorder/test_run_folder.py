from __future__ import annotations

import pytest

from missionkit.recorder.run_folder import keep_mission, run_folder, write_whole


def test_a_taken_name_gets_the_next_free_number(tmp_path):
    names = [run_folder(tmp_path / "runs", "precision-task", "1").name for _ in range(3)]
    assert names == ["precision-task-1", "precision-task-1-2", "precision-task-1-3"]


@pytest.mark.parametrize("mission", ["../../etc", "a/b", ".hidden", "späte Ernte: 2", ""])
def test_a_run_stays_below_its_root(tmp_path, mission):
    folder = run_folder(tmp_path / "runs", mission, "7")
    assert folder.parent == tmp_path / "runs"
    assert folder.is_dir()


def test_the_mission_is_kept_as_it_was(tmp_path):
    mission = tmp_path / "m.yaml"
    mission.write_bytes(b"mission: m  # caf\xc3\xa9\r\n")
    copy = keep_mission(run_folder(tmp_path, "m", "1"), mission)
    assert copy.name == "mission.yaml"
    assert copy.read_bytes() == mission.read_bytes()


def test_a_failed_write_leaves_the_old_file(tmp_path):
    path = tmp_path / "summary.json"
    write_whole(path, "old")
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(UnicodeEncodeError):
        write_whole(path, "new \ud800")
    assert path.read_text() == "old"
