"""The commands of the how-tos, run as they stand there, each against its simulated autopilot."""

import json
import os
import re
import shlex
import subprocess
import sys

import pytest
from documents import ROOT, document
from typer.testing import CliRunner
from vehicle.flying import SPEED, affordable, free_port

from missionkit.cli.app import app

PAGES = ("docs/how-to/fly-on-px4-sitl.md", "docs/how-to/fly-on-ardupilot-sitl.md")
LIFE = 500  # s; then the autopilot ends, even if its parent has died
MERCY = 5  # s between asking a process to end and killing it
PORTS = ("14540", "5760")
PATIENT = {PAGES[0]: ("--parameter", "COM_OF_LOSS_T=5"), PAGES[1]: ()}  # as `vehicle.flying`


def fenced(text, language):
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def commands(text):
    """Return what a page tells one to type, in order."""
    lines = [line for block in fenced(text, "sh") for line in block.splitlines()]
    lines = [line for line in lines if "--sitl" not in line]  # see test_own_sitl.py
    return [shlex.split(line) for line in lines]


def arguments(words, ports, *more):
    """Return the command's arguments, with free ports instead of those that may be taken."""
    moved = [re.sub("|".join(PORTS), lambda it: ports[it[0]], word) for word in words[1:]]
    return [*moved, *more]


@pytest.mark.parametrize("page", PAGES)
def test_every_command_of_a_page_does_what_it_says(page, tmp_path, monkeypatch):
    first, *_ = fenced(document(PAGES[0]), "yaml")
    (tmp_path / "first.yaml").write_text(first)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    ports = {port: str(free_port()) for port in PORTS}
    links = [f"udpout:127.0.0.1:{ports['14540']}", f"tcpin:127.0.0.1:{ports['5760']}"]
    (start, *others) = commands(document(page))
    assert start[:2] == ["missionkit", "sitl"]
    speed = f"{affordable(SPEED):.2f}"
    more = [
        "--speed",
        speed,
        "--json",
        *PATIENT[page],
        *(word for link in links for word in ("--link", link)),
    ]
    python = [sys.executable, "-m", "missionkit", *arguments(start, ports, *more)]
    mortal = ["timeout", f"--kill-after={MERCY}", str(LIFE), *python]
    around = os.environ | {"PYTHONPATH": str(ROOT)}
    with subprocess.Popen(mortal, stdout=subprocess.PIPE, env=around) as sitl:
        try:
            assert json.loads(sitl.stdout.readline())
            for words in others:
                fast = ("--speed", speed, "--headless") if words[1] == "run" else ()
                done = CliRunner().invoke(app, arguments(words, ports, *fast))
                assert done.exit_code == 0, done.output
        finally:
            sitl.terminate()
    runs = [json.loads(path.read_text()) for path in tmp_path.glob("runs/*/summary.json")]
    assert [run["outcome"] for run in runs] == ["success"] * sum(it[1] == "run" for it in others)
