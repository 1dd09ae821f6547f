"""Problems for people and for programs."""

from __future__ import annotations

import json

import pytest

from missionkit.cli.problem_report import (
    as_json,
    sources,
    summary,
    text,
)
from missionkit.cli.sarif import sarif
from missionkit.errors import Level, Place, Problem


def problem(line: int = 2, column: int = 3, **more: object) -> Problem:
    return Problem(Place("m.yaml", line, column), "it is wrong", **more)  # type: ignore[arg-type]


def shown(one: Problem, *lines: str) -> list[str]:
    return text([one], {"m.yaml": lines}).splitlines()


def test_the_caret_is_below_the_column():
    assert shown(problem(), "a:", "  b: 1") == [
        "m.yaml:2:3: error: it is wrong",
        "    b: 1",
        "    ^",
    ]


def test_code_level_and_remedy_are_printed():
    warning = problem(level=Level.WARNING, code="trap", remedy="add a transition to 'land'")
    assert shown(warning, "a:", "  b: 1") == [
        "m.yaml:2:3: warning[trap]: it is wrong",
        "    b: 1",
        "    ^",
        "  help: add a transition to 'land'",
    ]


@pytest.mark.parametrize(
    ("line", "column", "caret"),
    [
        ("\tb: 1", 2, "\t^"),
        ("漢字: 1", 3, "    ^"),  # each takes two cells of a terminal
        ("e\u0301: 1", 3, " ^"),  # the accent takes none
        ("abc", 9, "   ^"),  # past the end: something is missing there
        ("abc", 0, "^"),
    ],
)
def test_the_caret_counts_what_a_terminal_shows(line, column, caret):
    assert shown(problem(1, column), line)[2] == f"  {caret}"


def test_a_long_line_is_cut_around_the_column():
    _, line, caret = shown(problem(1, 501), "x" * 500 + "!" + "y" * 500)
    assert len(line) < 110
    assert line[caret.index("^")] == "!"
    assert (line[2], line[-1]) == ("…", "…")


def test_nothing_in_a_file_reaches_the_terminal_as_a_command():
    evil = Problem(Place("m.yaml", 1, 1), "\x1b[2Jbad", remedy="\x07")
    assert "\x1b" not in text([evil], {"m.yaml": ["\x1b[31m\x9b5m"]})
    assert "\x07" not in text([evil], {})


@pytest.mark.parametrize("place", [(0, 0), (9, 1), (3, 1)])
def test_a_place_without_a_line_has_no_caret(place):
    assert len(shown(problem(*place), "a:", "  b: 1", "   ")) == 1


def test_lines_are_counted_as_yaml_counts_them(tmp_path):
    path = tmp_path / "m.yaml"
    path.write_bytes("\ufeffa\r\nb\rc\u2028d\x85e\n".encode())
    one = Problem(Place(str(path), 1, 1), "")
    assert sources([one])[str(path)] == ["a", "b", "c", "d", "e", ""]


@pytest.mark.parametrize("name", ["missing.yaml", ".", "nul\0.yaml", ""])
def test_a_file_that_cannot_be_read_has_no_lines(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert not list(sources([Problem(Place(name, 1, 1), "")])[name])


def test_colours_change_nothing_but_colours():
    every = [problem(code="trap", remedy="do"), problem(level=Level.WARNING)]
    lines = {"m.yaml": ["a:", "  b: 1"]}
    painted = text(every, lines, colours=True)
    for code in ("\x1b[1;31m", "\x1b[1;33m", "\x1b[1;36m", "\x1b[0m"):
        assert code in painted
        painted = painted.replace(code, "")
    assert painted == text(every, lines)


def test_json_has_every_key():
    assert json.loads(as_json([problem(code="trap", level=Level.WARNING, remedy="do")])) == [
        {
            "file": "m.yaml",
            "line": 2,
            "column": 3,
            "level": "warning",
            "code": "trap",
            "message": "it is wrong",
            "remedy": "do",
        }
    ]


def test_the_summary_counts():
    assert summary([problem(), problem(level=Level.WARNING), problem()]) == "2 errors, 1 warning"


def test_sarif_has_a_rule_for_each_code_and_a_region_for_each_result():
    every = [
        problem(code="trap", remedy="do"),
        problem(code="shadowed", level=Level.WARNING),
        problem(),
        problem(code="trap"),
    ]
    log = json.loads(sarif(every))
    (run,) = log["runs"]
    rules = [rule["id"] for rule in run["tool"]["driver"]["rules"]]
    assert (log["version"], rules) == ("2.1.0", ["mission-file", "shadowed", "trap"])
    assert [rules[it["ruleIndex"]] for it in run["results"]] == [
        it["ruleId"] for it in run["results"]
    ]
    assert [it["level"] for it in run["results"]] == ["error", "warning", "error", "error"]
    first = run["results"][0]
    assert first["message"]["text"] == "it is wrong\n\nRemedy: do"
    (location,) = first["locations"]
    assert location["physicalLocation"] == {
        "artifactLocation": {"uri": "m.yaml"},
        "region": {"startLine": 2, "startColumn": 3},
    }


@pytest.mark.parametrize(
    ("file", "uri"),
    [("a b/ü.yaml", "a%20b/%C3%BC.yaml"), ("/x/m.yaml", "file:///x/m.yaml"), ("a:b", "a%3Ab")],
)
def test_sarif_names_files_as_uris(file, uri):
    (run,) = json.loads(sarif([Problem(Place(file, 0, 0), "")]))["runs"]
    (location,) = run["results"][0]["locations"]
    assert location == {"physicalLocation": {"artifactLocation": {"uri": uri}}}
