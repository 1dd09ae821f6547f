"""The page about the command line says what the commands say."""

from __future__ import annotations

import re

import typer
from documents import ROOT, document, table

from missionkit.cli.app import app

PAGE = document("docs/reference/command-line.md")
COMMANDS = typer.main.get_command(app).commands


def test_every_command_is_documented():
    documented = [row[0].strip("`") for row in table(PAGE, "The command line")]
    assert set(documented) <= set(COMMANDS)
    assert {"validate", "explain", "graph", "run"} <= set(documented)


def test_every_option_of_validate_is_documented():
    documented = {row[0].strip("`") for row in table(PAGE, "validate")} | set(
        re.findall(r"--\w+", PAGE)
    )
    options = {name for it in COMMANDS["validate"].params for name in it.opts if name[:2] == "--"}
    assert options - {"--help"} <= documented


def test_the_example_is_what_explain_says(call, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    example = re.search(r"^visual, of kind.*?(?=^```)", PAGE, re.MULTILINE | re.DOTALL)
    assert example is not None
    assert example[0] in call("explain", str(ROOT / "missions" / "precision_task.yaml")).stdout
