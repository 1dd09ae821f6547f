"""A pipe, a device or a folder where a file is expected: a sentence at once."""

import os

import pytest
from typer.testing import CliRunner

from missionkit.cli.app import app

MISSION = """\
missionkit: 1
mission: m
initial: a
{}
states:
  a: {{kind: idle, transitions: [{{to: land, after: 1}}]}}
  b: {}
  land: {{kind: land}}
"""
PLAIN = "{kind: idle}"


@pytest.fixture
def pipe(tmp_path):
    path = tmp_path / "pipe.yaml"
    os.mkfifo(path)
    os.mkfifo(tmp_path / "pipe.png")
    return path


def output_of(*words):
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exit_code == 2, done.output
    return done.output


@pytest.mark.parametrize("command", ["validate", "explain", "run"])
def test_a_pipe_is_not_a_mission(command, pipe):
    assert "pipe.yaml:1:1: " in (said := output_of(command, pipe))
    assert "cannot be read: it is a pipe, not a file" in said


@pytest.mark.parametrize(("path", "what"), [("/dev/zero", "a device"), (".", "a folder")])
def test_neither_is_a_device_or_a_folder(path, what):
    assert f"cannot be read: it is {what}, not a file" in output_of("validate", path)


@pytest.mark.parametrize(
    ("top", "state"),
    [
        ("world: pipe.yaml", PLAIN),
        ("map: {file: pipe.yaml}", PLAIN),
        ("map: {file: map.yaml}", PLAIN),
        ("", "{include: pipe.yaml}"),
    ],
)
def test_neither_is_what_a_mission_names(top, state, pipe):
    (pipe.parent / "map.yaml").write_text("image: pipe.png\nresolution: 1\norigin: [0, 0, 0]\n")
    mission = pipe.parent / "m.yaml"
    mission.write_text(MISSION.format(top, state))
    assert "it is a pipe, not a file" in output_of("validate", mission)


def test_neither_is_a_plug_in(pipe):
    mission = pipe.parent / "m.yaml"
    mission.write_text(MISSION.format("", PLAIN))
    assert "it is a pipe, not a file" in output_of("validate", mission, "--plugin", pipe)
