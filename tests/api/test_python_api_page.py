"""The page about the Python API is up to date, complete, and its examples run."""

import doctest
import re
from pathlib import Path
from types import SimpleNamespace

import pytest

import missionkit
from docs.python_api import PAGE, PARTS, page
from missionkit.cli.scaffold import new

BLOCKS = re.findall(r"^```pycon\n(.*?)^```", PAGE.read_text(), re.MULTILINE | re.DOTALL)


def test_the_page_is_what_the_public_names_say(update_refs):
    if update_refs:
        PAGE.write_text(page(), encoding="utf-8")
    assert PAGE.read_text(encoding="utf-8") == page()  # make reference


def test_every_public_name_has_its_place_and_example():
    documented = [name for names in PARTS.values() for name in names]
    assert sorted([*documented, "__version__"]) == sorted(missionkit.__all__)
    entries = re.split(r"^### ", PAGE.read_text(), flags=re.MULTILINE)[1:]
    assert [it.split("\n")[0] for it in entries] == documented
    assert [it.split("\n")[0] for it in entries if "```pycon" not in it] == []


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A mission that was flown, and one tick on its way out."""
    root = tmp_path_factory.mktemp("examples")
    written, _ = new("mission", "first-flight", root)
    written.rename(root / "mission.yaml")
    mission = missionkit.load(root / "mission.yaml")
    ticks = []
    summary = missionkit.rehearse(mission, observers=[lambda *tick: ticks.append(tick)])
    out = [tick for tick in ticks if tick[0].state == "out"]
    record, observation = out[len(out) // 2]
    return SimpleNamespace(root=root, names={
        "missionkit": missionkit, "mission": mission, "summary": summary, "record": record,
        "observation": observation, "seen": record.estimate,
    })  # fmt: skip


def test_every_example_gives_what_it_says(flown, monkeypatch):
    monkeypatch.chdir(flown.root)
    address = []  # a flight over MAVLink has its own test

    def fly(mission, to, **_):
        address.append(to)
        return flown.names["summary"]

    monkeypatch.setattr(missionkit, "fly", fly, raising=False)
    runner, said = doctest.DocTestRunner(), []
    names = dict(flown.names)
    for text in BLOCKS:
        test = doctest.DocTestParser().get_doctest(text, names, text.split("\n")[0], str(PAGE), 0)
        runner.run(test, out=said.append, clear_globs=False)
        names = test.globs
    assert "".join(said) == ""
    assert address == ["udpin://0.0.0.0:14540"]
    assert Path("runs/cruise/report.html").exists()
