"""`missionkit validate` and `missionkit graph`, with what the proof finds."""

from __future__ import annotations

import json

import pytest

from missionkit.chart import checks
from missionkit.errors import Level, Problem


@pytest.fixture
def found(monkeypatch):
    """Let the proof find what a test says about the first transition of `idle`."""

    def find(level: Level) -> None:
        def findings(mission, catalogue, **_):
            way = mission.states["idle"].transitions[0]
            return [Problem(way.place("when"), "never", level, "dead", "say when")]

        monkeypatch.setattr(checks, "findings", findings)

    return find


BLOCK = """\
hop.yaml:10:36: {level}[dead]: never
      transitions: [{{to: land, when: done}}]
                                     ^
  help: say when
"""


@pytest.mark.parametrize(
    ("level", "options", "code", "out", "end"),
    [
        (Level.ERROR, [], 2, "", "hop.yaml: 1 error\n"),
        (Level.WARNING, [], 0, "hop.yaml: ok, 1 warning (2 states, 0 guards, 0 failsafes)\n", ""),
        (Level.WARNING, ["--strict"], 2, "", "hop.yaml: 1 warning\n"),
    ],
)
def test_findings_are_reported_by_level(call, found, level, options, code, out, end):
    found(level)
    result = call("validate", "hop.yaml", *options)
    assert (result.exit_code, result.stdout) == (code, out)
    assert result.stderr == BLOCK.format(level=level) + end


def test_several_files_are_checked_at_once(call, hop):
    (hop.parent / "bad.yaml").write_text(hop.read_text().replace("kind: idle", "kind: idel"))
    (hop.parent / "list.yaml").write_text("- 1\n")
    result = call("validate", "bad.yaml", "hop.yaml", "list.yaml", "none.yaml")
    assert result.exit_code == 2
    assert result.stdout == "hop.yaml: ok (2 states, 0 guards, 0 failsafes)\n"
    for start in ("bad.yaml:8:11: error: ", "list.yaml:1:1: error: ", "none.yaml:1:1: error: "):
        assert f"\n{start}" in f"\n{result.stderr}"
    printed = json.loads(call("validate", "bad.yaml", "none.yaml", "--format", "json").stdout)
    assert [it["file"] for it in printed] == ["bad.yaml", "none.yaml"]


def test_formats_for_programs_write_only_to_stdout(call, found):
    found(Level.ERROR)
    result = call("validate", "hop.yaml", "--format", "sarif")
    assert (result.exit_code, result.stderr) == (2, "")
    (result,) = json.loads(result.stdout)["runs"][0]["results"]
    assert result["ruleId"] == "dead"
    (printed,) = json.loads(call("validate", "hop.yaml", "--format", "json").stdout)
    assert (printed["code"], printed["level"], printed["remedy"]) == ("dead", "error", "say when")


def test_an_unusable_plugin_file_is_reported_in_every_format(call, tmp_path):
    (tmp_path / "empty.py").write_text("x = 1\n")
    result = call("validate", "hop.yaml", "--plugin", "empty.py", "--format", "json")
    assert result.exit_code == 2
    assert [it["file"] for it in json.loads(result.stdout)] == ["empty.py"]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["validate"], "missionkit validate: MISSION.yaml ... is missing"),
        (["validate", "hop.yaml", "--format", "jsn"], "--format jsn: unknown; did you mean 'json'"),
        (["explain", "none.yaml"], "no such file or directory; did you mean 'hop.yaml'?"),
    ],
)
def test_misuse_is_explained(call, arguments, says):
    result = call(*arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert says in result.stderr


def test_the_graph_marks_what_the_proof_finds(call, found, hop):
    assert "[1]" not in call("graph", "hop.yaml").stdout
    found(Level.ERROR)
    assert "s0_idle --> s1_land : [1] done" in call("graph", "hop.yaml").stdout
    call("graph", "hop.yaml", "--out", "hop.svg")
    assert 'class="arrow marked"' in (hop.parent / "hop.svg").read_text()


@pytest.mark.parametrize(
    ("terminal", "old", "new", "hints"),
    [
        (True, "kind: idle", "kind: idel", 1),
        (True, "mission: ", "misson: ", 1),
        (
            True,
            "missionkit: 1",
            "# yaml-language-server: $schema=s.json\nmissionkit: 1\nmap_: 2",
            0,
        ),
        (True, "missionkit: 1", "missionkit: 1", 0),
        (False, "kind: idle", "kind: idel", 0),
    ],
)
def test_a_terminal_hints_at_the_schema_where_a_word_is_unknown(
    call, hop, monkeypatch, terminal, old, new, hints
):
    assert old in hop.read_text()
    hop.write_text(hop.read_text().replace(old, new))
    monkeypatch.setattr("typer.testing._NamedTextIOWrapper.isatty", lambda _: terminal)
    monkeypatch.setenv("NO_COLOR", "1")
    said = call("validate", "hop.yaml", "hop.yaml").stderr
    assert said.count("`missionkit schema --for hop.yaml") == hints
