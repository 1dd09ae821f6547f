"""Tutorials and how-tos do what they say: their files, commands and Python run in order."""

import re
import shlex
import sys
from pathlib import PurePath

import pytest
from documents import ROOT, document
from typer.testing import CliRunner

from missionkit.cli.app import app

BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
NAMED = re.compile(r"# (\S+\.(?:py|yaml))\n")
FIRST, PYTHON = "docs/tutorial/first-mission.md", "docs/tutorial/from-python.md"


def written(page, folder):
    """Write the files of a page; return its other blocks, with their languages, in order."""
    rest = []
    for language, text in BLOCK.findall(document(page)):
        if name := NAMED.match(text):
            (folder / name[1]).write_text(text)
        else:
            rest.append((language, text))
    return rest


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder to work in, from which Python imports."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    before = set(sys.modules)
    yield tmp_path
    for name in set(sys.modules) - before:
        if name.startswith(("missionkit_", "windy", "count")):
            del sys.modules[name]


def call(line):
    program, *words = shlex.split(line, comments=True) or [""]
    if program != "missionkit":
        return None
    result = CliRunner().invoke(app, words)
    return line, result.exit_code, result.output


@pytest.fixture
def patrol(folder):
    """Where the second tutorial begins."""
    written(FIRST, folder)
    assert call("missionkit new mission first-flight")[1] == 0
    return folder


def test_the_first_mission_is_checked_changed_flown_and_counted(folder):
    lines = [ln for lang, text in written(FIRST, folder) if lang == "sh" for ln in text.split("\n")]
    answers = [answer for line in lines if (answer := call(line))]
    failed = [line for line, code, _ in answers if code != 0]
    assert [it for it in failed if "link_lost" not in it] == []
    said = {line: output for line, _, output in answers}
    assert "ok (5 states" in said["missionkit validate patrol.yaml"]
    assert "success: flown as planned" in said["missionkit run patrol.yaml --seed 1 --headless"]
    lost = next(output for line, output in said.items() if "link_lost" in line)
    assert "failsafe link" in lost
    assert list(folder.glob("runs/patrol-campaign-seed0/report.html"))


def test_the_python_tutorial_runs(patrol, capsys):
    names = {}
    for language, text in written(PYTHON, patrol):
        if language == "python":
            exec(compile(text, PYTHON, "exec"), names)  # noqa: S102 - the project's own page
    said = capsys.readouterr().out
    assert "success - flown as planned" in said
    assert "True" in said
    assert "out -> watch: when done" in said
    assert "up to 12" in said
    assert "landed because the operator requested it" in said
    compile((patrol / "over_mavlink.py").read_text(), "over_mavlink.py", "exec")


@pytest.mark.parametrize(
    "page", ["docs/how-to/write-a-guard.md", "docs/how-to/write-a-behavior.md"]
)
def test_a_how_to_of_plugins_runs(page, folder):
    rest = written(page, folder)
    names = {}
    for language, text in rest:
        if language == "python":
            exec(compile(text, page, "exec"), names)  # noqa: S102
    for path in folder.glob("missionkit_*.py"):
        shown = CliRunner().invoke(app, ["plugins", "--plugin", str(path)])
        assert path.stem.removeprefix("missionkit_") in shown.output


def test_the_site_has_every_page():
    index = document("docs/index.md")
    listed = re.findall(r"^([\w/*-]+)$", index, re.MULTILINE)
    pages = [str(it.relative_to(ROOT / "docs")) for it in (ROOT / "docs").rglob("*.md")]
    lost = [it for it in pages if not any(PurePath(it).match(f"{name}.md") for name in listed)]
    assert lost == ["index.md"]
