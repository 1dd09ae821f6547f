from __future__ import annotations

from dataclasses import replace
from importlib.metadata import EntryPoint, EntryPoints
from pathlib import Path

import pytest

from missionkit.chart import plugin_catalogue as module
from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.plugin_check import checked
from missionkit.chart.plugin_groups import PLUGIN_GROUPS
from missionkit.errors import FileError, UsageError
from missionkit.plugin import Plugin

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
    assert "higher" not in catalogue.group("guards")
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
        ("raise KeyboardInterrupt\n", "mine.py:1:1: cannot be imported: KeyboardInterrupt"),
        ("raise GeneratorExit(1)\n", "mine.py:1:1: cannot be imported: GeneratorExit: 1"),
        ("import nowhere\n", "mine.py:1:1: cannot be imported: ModuleNotFoundError"),
        ("x = (\n", "mine.py:1:5: cannot be imported: '(' was never closed"),
        ("x = 1\n", "mine.py:1:1: no plug-in here: define a class with a `kind`"),
        (
            PLUGIN.format(kind="higher", method="chek"),
            "mine.py:11:1: Higher lacks the method check",
        ),
    ],
)
def test_a_file_that_is_not_a_plugin(tmp_path: Path, catalogue: Catalogue, text: str, message: str):
    with pytest.raises(FileError) as error:
        catalogue.with_file(written(tmp_path, text))
    assert str(error.value).partition("mine.py")[2].startswith(message.removeprefix("mine.py"))


def test_ctrl_c_during_an_import_is_not_blamed_on_the_file(tmp_path: Path, catalogue: Catalogue):
    waits = "import os, signal\nos.kill(os.getpid(), signal.SIGINT)\nfor _ in range(1000): pass\n"
    with pytest.raises(KeyboardInterrupt):
        catalogue.with_file(written(tmp_path, waits))


def test_a_file_that_is_missing(tmp_path: Path, catalogue: Catalogue):
    with pytest.raises(FileError, match="cannot be read"):
        catalogue.with_file(tmp_path / "nowhere.py")


def test_two_plugins_of_one_name_are_refused(tmp_path: Path, catalogue: Catalogue):
    path = written(tmp_path, PLUGIN.format(kind="within", method="check"))
    with pytest.raises(
        UsageError, match=r"'within': missionkit\.guards\.distances\.Within and .*mine"
    ):
        catalogue.with_file(path)


def installed(monkeypatch: pytest.MonkeyPatch, value: str, name: str = "mine") -> None:
    entry = EntryPoint(name, value, "missionkit.guards")
    monkeypatch.setattr(module, "entry_points", lambda: EntryPoints([entry]))


def test_installed_plugins_are_found(monkeypatch: pytest.MonkeyPatch, catalogue: Catalogue):
    without = replace(catalogue, plugins={**catalogue.plugins, "guards": {}})
    installed(monkeypatch, "missionkit.guards.distances:Within")
    assert list(without.with_entry_points().group("guards")) == ["within"]


IDLE = """\
missionkit: 1
mission: m
initial: idle
states: {idle: {kind: idle, transitions: [{to: idle, when: %s}]}}
"""


@pytest.mark.parametrize("when", ["mine", "{use: mine}"])
@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("missionkit.nowhere:Within", "missionkit.nowhere:Within cannot be imported: Module"),
        ("missionkit.guards.distances:norm", "is not a class"),
        ("missionkit.plugin:Guard", "Guard has no `kind`"),
        (
            "missionkit.behaviors.hold:Hold",
            "Hold lacks the method check and the method region of a",
        ),
    ],
)
def test_an_installed_plugin_that_is_broken_matters_only_where_it_is_used(
    monkeypatch: pytest.MonkeyPatch, catalogue: Catalogue, value: str, message: str, when: str
):
    installed(monkeypatch, value)
    found = catalogue.with_entry_points()
    assert found.group("guards") == catalogue.group("guards")
    assert message in found.broken["guards", "mine"]
    parse(IDLE % "done", "m.yaml", found)
    with pytest.raises(FileError, match=r"guard 'mine' cannot be used: ") as refusal:
        parse(IDLE % when, "m.yaml", found)
    assert message in str(refusal.value)


@pytest.mark.parametrize("error", [OSError, KeyboardInterrupt, SystemExit])
def test_a_package_may_raise_anything_when_it_is_imported(
    monkeypatch: pytest.MonkeyPatch, catalogue: Catalogue, error: type[BaseException]
):
    def load(_: EntryPoint) -> None:
        raise error("no")

    installed(monkeypatch, "theirs:Mine")
    monkeypatch.setattr(EntryPoint, "load", load)
    why = catalogue.with_entry_points().broken["guards", "mine"]
    assert why == f"theirs:Mine cannot be imported: {error.__name__}: no"


def test_a_package_does_not_take_the_place_of_a_plugin_of_ours(
    monkeypatch: pytest.MonkeyPatch, catalogue: Catalogue
):
    within = catalogue.group("guards")["within"]
    mine = type("Mine", (within,), {"__module__": "theirs", "kind": "within"})
    installed(monkeypatch, "theirs:Mine", "within")
    monkeypatch.setattr(EntryPoint, "load", lambda _: mine)
    found = catalogue.with_entry_points()
    assert found.group("guards")["within"] is catalogue.group("guards")["within"]
    assert "two guards are called 'within'" in found.broken["guards", "within"]


def test_of_two_packages_with_one_name_neither_is_guessed(
    monkeypatch: pytest.MonkeyPatch, catalogue: Catalogue
):
    within = catalogue.group("guards")["within"]
    kinds = [type("Mine", (within,), {"__module__": it, "kind": "mine"}) for it in ("a", "b")]
    entries = [EntryPoint("mine", f"{it}:Mine", "missionkit.guards") for it in ("a", "b")]
    monkeypatch.setattr(module, "entry_points", lambda: EntryPoints(entries))
    monkeypatch.setattr(EntryPoint, "load", lambda it: kinds[entries.index(it)])
    found = catalogue.with_entry_points()
    assert "mine" not in found.group("guards")
    with pytest.raises(FileError, match="two guards are called 'mine'"):
        parse(IDLE % "{use: mine}", "m.yaml", found)


class Sightless(Plugin):
    """Builds nothing."""

    kind = "sightless"


class Hasty(Plugin):
    """Takes too little."""

    kind = "hasty"

    def build(self):
        return None


class Calm(Plugin):
    """Steps without a beginning."""

    kind = "calm"

    def step(self, memory, seen, goal, wanted):
        return wanted, memory


@pytest.mark.parametrize(
    ("group", "plugin", "says"),
    [
        ("navigators", Sightless, "Sightless lacks the method build"),
        ("navigators", Hasty, "Hasty.build must take 2 arguments"),
        ("planners", Calm, "Calm lacks the method begin"),
        ("detectors", Calm, "Calm lacks the method boxes of a detector"),
        ("behaviors", Calm, "Calm lacks the method begin and the method targets and the"),
    ],
)
def test_every_kind_of_plugin_is_looked_at_when_it_is_loaded(group, plugin, says):
    with pytest.raises(UsageError) as error:
        checked(plugin, group)
    assert says in str(error.value)


def test_all_of_ours_are_what_they_should_be(catalogue: Catalogue):
    for group in PLUGIN_GROUPS:
        for name, plugin in catalogue.group(group).items():
            assert checked(plugin, group) is plugin
            assert plugin.kind == name
