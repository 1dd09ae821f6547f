from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.cli.app import app
from missionkit.cli.detector_training import TrainingOptions, train
from missionkit.errors import ExitCode
from missionkit.perception.template.template_set import TemplateSet
from missionkit.sim import detector_training

WORLD = "world: hall\nground: {texture: concrete}\nrobots: {}\n"
MISSION = """\
missionkit: 1
mission: herd
perception:
  - {use: template, templates: mine.yaml}
  - {use: haar, least_score: 0.4}
initial: idle
states: {idle: {kind: idle}, land: {kind: land}}
"""


def test_it_trains_tests_and_writes_a_file_that_a_mission_names(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(detector_training, "variations_of", lambda it: {"as trained": it})
    world, out = tmp_path / "hall.yaml", tmp_path / "mine.yaml"
    world.write_text(WORLD)
    train(TrainingOptions("template", (world,), 16, 40, 10, 2, 3), out)
    said = capsys.readouterr()
    assert "20 templates from 40 objects" in said.err
    lines = said.out.splitlines()
    assert lines[0].startswith("as trained: ")
    assert "robots found" in lines[0]
    assert lines[1] == f"wrote {out}: {out.stat().st_size / 1e3:.0f} kB"
    written = TemplateSet.model_validate(json.loads(out.read_text()))
    assert written.trained["floors"] == "hall"
    (tmp_path / "herd.yaml").write_text(MISSION)
    mission = load(tmp_path / "herd.yaml", builtin())
    assert mission.perception[0].plugin.templates == written


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--kind", "har", "--out", "a.yaml"], "--kind har: no such detector; did you mean 'haar'"),
        (["--out", "a.npz"], "--out a.npz: expected a name that ends in .yaml"),
        (["--out", "a.yaml", "--world", "none.yaml"], "none.yaml"),
    ],
)
def test_what_it_cannot_do_it_says_in_a_sentence(options, says):
    answer = CliRunner().invoke(app, ["detector", "train", *options])
    assert answer.exit_code == ExitCode.BAD_FILE
    assert says in answer.stderr
    assert "Traceback" not in answer.stderr
