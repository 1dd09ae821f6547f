"""The chart in sentences, as the terminal shows it."""

from __future__ import annotations

import pytest

from missionkit.chart.prose.state_text import item, sentence, topic
from missionkit.cli.explain_command import page, width


def test_paragraphs_are_wrapped_with_their_margins():
    paragraphs = [
        topic("gps, of kind gps"),
        sentence("word " * 12),
        item("to land " * 8),
        topic("b", 1),
    ]
    assert page(paragraphs, 40).splitlines() == [
        "gps, of kind gps",
        "  word word word word word word word",
        "  word word word word word",
        "  - to land to land to land to land to",
        "    land to land to land to land",
        "",
        "  b",
    ]


@pytest.mark.parametrize(("columns", "set_to"), [("20", 40), ("72", 72), ("400", 100)])
def test_the_width_is_that_of_the_terminal_within_reason(monkeypatch, columns, set_to):
    monkeypatch.setenv("COLUMNS", columns)
    assert width() == set_to


def test_a_mission_is_explained_within_the_width(call, monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    result = call("explain", "hop.yaml", "--set", "height=3")
    assert (result.exit_code, result.stderr) == (0, "")
    assert max(map(len, result.stdout.splitlines())) <= 60
    assert "take off (height 3)" in result.stdout
    assert "  - to land when its behaviour is done.\n" in result.stdout
