from __future__ import annotations

from importlib.metadata import EntryPoint, EntryPoints
from pathlib import Path

import pytest

from missionkit.chart import catalogue as module
from missionkit.chart.catalogue import Catalogue
from missionkit.chart.load import parse
from missionkit.errors import FileError, UsageError

PLUGIN = '''
from __future__ import annotations

from typing import ClassVar

from missionkit.messages import Estimate, Verdict
from missionkit.plugin import Guard
from missionkit.units import Metres


class Higher(Guard):
    """Holds above `height`."""

    kind: ClassVar[str] = "{kind}"
    height: Metres = 3.0

    def {method}(self, seen: Estimate) -> Verdict:
        return Verdict.above(-seen.position[2], self.height)
'''


def written(folder: Path, text: str) -> Path:
    path = folder / "mine.py"
    path.write_text(text)
    return path


def test_a_guard_in_a_file_is_used_from_a_mission(tmp_path: Path, catalogue: Catalogue):
    path = written(tmp_path, PLUGIN.format(kind="higher", method="check"))
    extended = catalogue.with_file(path)
    assert "higher" not in catalogue.guards
    mission = parse(
        "missionkit: 1\nmission: m\ninitial: idle\n"
        "states: {idle: {kind: idle, transitions: [{to: idle, when: {use: higher, height: 4}}]}}\n",
        "m.yaml",
        extended,
    )
    assert mission.states["idle"].transitions[0].when is not None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = 1\nraise KeyError('x')\n", "mine.py:2:1: cannot be imported: KeyError: 'x'"),
        ("import sys\nsys.exit(3)\n", "mine.py:2:1: cannot be imported: SystemExit: 3"),
        ("import nowhere\n", "mine.py:1:1: cannot be imported: ModuleNotFoundError"),
        ("x = (\n", "mine.py:1:5: cannot be imported: '(' was never closed"),
        ("x = 1\n", "mine.py:1:1: no plug-in here: define a class with a `kind`"),
        (
            PLUGIN.format(kind="higher", method="chek"),
            "mine.py:11:1: Higher lacks the method check",
        ),
    ],
)
def test_a_file_that_is_no_plugin(tmp_path: Path, catalogue: Catalogue, text: str, message: str):
    with pytest.raises(FileError) as error:
        catalogue.with_file(written(tmp_path, text))
    assert str(error.value).partition("mine.py")[2].startswith(message.removeprefix("mine.py"))


def test_a_file_that_is_missing(tmp_path: Path, catalogue: Catalogue):
    with pytest.raises(FileError, match="cannot be read"):
        catalogue.with_file(tmp_path / "nowhere.py")


def test_two_plugins_of_one_name_are_refused(tmp_path: Path, catalogue: Catalogue):
    path = written(tmp_path, PLUGIN.format(kind="within", method="check"))
    with pytest.raises(UsageError, match=r"'within': missionkit\.guards\.range\.Within and .*mine"):
        catalogue.with_file(path)


def installed(monkeypatch: pytest.MonkeyPatch, value: str) -> None:
    entry = EntryPoint("mine", value, "missionkit.guards")

    def entry_points(group: str) -> EntryPoints:
        return EntryPoints([entry]).select(group=group)

    monkeypatch.setattr(module, "entry_points", entry_points)


def test_installed_plugins_are_found(monkeypatch: pytest.MonkeyPatch, catalogue: Catalogue):
    without = Catalogue(**{**vars(catalogue), "guards": {}})
    installed(monkeypatch, "missionkit.guards.range:Within")
    assert list(without.with_entry_points().guards) == ["within"]


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("missionkit.nowhere:Within", "cannot be imported"),
        ("missionkit.guards.range:norm", "not a class derived from Plugin"),
    ],
)
def test_installed_plugins_that_are_none(
    monkeypatch: pytest.MonkeyPatch, catalogue: Catalogue, value: str, message: str
):
    installed(monkeypatch, value)
    with pytest.raises(UsageError, match=message):
        catalogue.with_entry_points()
