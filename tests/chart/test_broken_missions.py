"""Each file in tests/broken says exactly what the .txt beside it holds.

`pytest tests/chart/test_broken_missions.py --update-refs` writes the .txt files.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.errors import ExitCode, FileError

FOLDER = Path(__file__).parents[1] / "broken"
FILES = sorted(path.name for path in FOLDER.glob("*.yaml"))


@pytest.mark.parametrize("name", FILES)
def test_message(name: str, catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch, update_refs):
    monkeypatch.chdir(FOLDER)
    with pytest.raises(FileError) as error:
        load(Path(name), catalogue)
    if update_refs:
        Path(name).with_suffix(".txt").write_text(f"{error.value}\n")
    assert f"{error.value}\n" == Path(name).with_suffix(".txt").read_text()
    assert error.value.exit_code is ExitCode.BAD_FILE


def test_there_are_at_least_twenty():
    assert len(FILES) >= 20
    assert {Path(name).stem for name in FILES} == {path.stem for path in FOLDER.glob("*.txt")}
