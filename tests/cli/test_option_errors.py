"""Every mistake in the use of a command is one sentence: where, what was wrong, what is right."""

from __future__ import annotations

import re
from typing import get_args, get_type_hints

import pytest
from typer.main import get_command
from typer.testing import CliRunner

from missionkit.cli.app import app

MISTAKES = {
    "run hop.yaml --seed x": "missionkit run: --seed: expected a whole number, got 'x'",
    "run hop.yaml --seed 1.5": "missionkit run: --seed: expected a whole number, got '1.5'",
    "run hop.yaml --seed -1": "missionkit run: --seed: expected 0 or more, got '-1'",
    "run hop.yaml --seed": "missionkit run: --seed: its value is missing",
    "run hop.yaml --speed nan": "missionkit run: --speed: expected 0.01 or more, got 'nan'",
    "run hop.yaml --system 300": "missionkit run: --system: expected 255 or less, got '300'",
    "run hop.yaml --seeed 3": "missionkit run: no option --seeed; did you mean '--seed'?",
    "run hop.yaml more": "missionkit run: 'more' is one argument too many",
    "validate": "missionkit validate: MISSION.yaml ... is missing",
    "new guard": "missionkit new: name is missing",
    "camera calibrat": "missionkit camera: no command 'calibrat'; did you mean 'calibrate'?",
    "fligh": "missionkit: no command 'fligh'; did you mean 'preflight'?",
    "--versio": "missionkit: no option --versio; did you mean '--version'?",
}


@pytest.mark.parametrize("words", MISTAKES)
def test_a_mistake_on_the_command_line_is_one_sentence(call, words):
    result = call(*words.split())
    assert result.exit_code == 2
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    assert line.startswith(MISTAKES[words])
    assert re.search(r"; missionkit[a-z ]* --help says what it takes$", line)


def numeric_options():
    def walk(command, path):
        for name, below in getattr(command, "commands", {}).items():
            yield from walk(below, (*path, name))
        types = {} if command.callback is None else get_type_hints(command.callback)
        for param in command.params:
            if {int, float} & {types.get(param.name), *get_args(types.get(param.name))}:
                yield (*path, max(param.opts, key=len))

    return list(walk(get_command(app), ()))


@pytest.mark.parametrize("words", numeric_options(), ids=" ".join)
def test_no_option_answers_in_the_words_of_the_library(words):
    result = CliRunner().invoke(app, [*words, "x"])
    command, option = " ".join(words[:-1]), words[-1]
    assert re.match(rf"missionkit {command}: {option}: expected a (whole )?number", result.output)


@pytest.mark.parametrize("words", [[], ["--help"], ["run", "--help"], ["--version"]])
def test_asking_for_help_is_not_an_error(words):
    result = CliRunner().invoke(app, words)
    assert "says what it takes" not in result.output
    assert len(result.output) > 5


def test_an_origin_that_is_not_text_is_reported_in_one_sentence(call, tmp_path):
    (tmp_path / "origin.json").write_bytes(bytes([255, 254, 0]))
    result = call("run", "--resume", str(tmp_path))
    assert result.exit_code == 2
    assert result.stderr == f"{tmp_path}/origin.json: cannot be used: not UTF-8 text\n"
