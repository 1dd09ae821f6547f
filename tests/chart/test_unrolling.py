"""A state for each thing of a list."""

from __future__ import annotations

import pytest
from stepping import CATALOGUE, HEAD, Walk, chart_of

from missionkit.chart.checks import findings
from missionkit.chart.drawing.mermaid_text import mermaid
from missionkit.chart.load import load, parse
from missionkit.errors import FileError

POLES = """\
params: {poles: [p1, p2, p3]}
targets: {p1: {position: [9, 0, -3]}, p2: {position: [0, 9, -3]}, p3: {position: [9, 9, -3]}}
dwell: 0.04
initial: poles
states:
  poles:
    for_each: {pole: $poles}
    retries: 1
    initial: go
    states:
      go:
        kind: custom
        behavior: {use: go_to, target: $pole}
        transitions:
          - {to: seen, when: {all: [a, {in: go}]}}
          - {to: skip, when: b, do: [{log: not there}]}
          - {to: retry, when: c}
      seen: {final: true}
    transitions:
      - {to: skip, after: 60}
      - {to: away, when: {variable: poles/skipped, at_least: 2}}
      - {to: home, when: done}
  away: {kind: custom}
  home: {kind: land}
"""


def counted(walk):
    return tuple(walk.memory.variables[f"poles/{it}"] for it in ("done", "skipped", "tries"))


def test_each_thing_has_its_copy_with_its_own_names():
    tree = parse(HEAD + POLES, "m.yaml", CATALOGUE).by_name()
    assert [name for name in tree if name.startswith("poles")] == [
        "poles",
        *(f"poles/p{n}{inner}" for n in (1, 2, 3) for inner in ("", "/go", "/seen")),
        "poles/finished",
    ]
    flown = [tree[f"poles/p{n}/go"].state.behavior.plugin.target for n in (1, 2, 3)]
    assert flown == ["p1", "p2", "p3"]


def test_they_come_one_after_the_other():
    walk = Walk(POLES)
    assert walk.state == "poles/p1/go"
    for n in (1, 2, 3):
        assert walk.state == f"poles/p{n}/go"
        walk.tick("a")
    walk.tick()
    assert walk.state == "home"
    assert counted(walk) == (3, 0, 0)


def test_one_is_skipped_and_one_is_tried_again_once():
    walk = Walk(POLES)
    walk.tick("b")
    assert (walk.state, counted(walk)) == ("poles/p2/go", (0, 1, 0))
    walk.tick("c")
    assert (walk.state, counted(walk)) == ("poles/p2/go", (0, 1, 1))
    walk.tick("a")
    assert (walk.state, counted(walk)) == ("poles/p3/go", (1, 1, 0))
    walk.tick("c")
    walk.tick("c")
    assert counted(walk) == (1, 2, 0)
    assert walk.state == "away"  # a way of the whole, by its counter


def test_a_transition_of_the_state_that_skips_belongs_to_each_copy():
    walk = Walk(POLES)
    walk.run(61.0)
    assert (walk.state, counted(walk)) == ("poles/p2/go", (0, 1, 0))


def test_a_state_without_states_inside_is_done_by_its_behaviour():
    text = POLES[: POLES.index("    initial: go")] + (
        "    kind: gps\n    behavior: {use: go_to, target: $pole}\n"
        "    transitions: [{to: home, when: done}]\n  home: {kind: land}\n"
    )
    walk = Walk(text)
    walk.tick()
    assert walk.state == "poles/p1"
    walk.tick(done=True)
    assert walk.state == "poles/p2"


def test_a_guard_that_names_a_state_means_that_of_its_copy():
    looked = POLES.replace("when: {all: [a, {in: go}]}", "when: {use: visited, state: go}")
    walk = Walk(looked)
    walk.tick()
    assert walk.state == "poles/p2/go"  # p1's was visited
    with pytest.raises(FileError, match="unknown state 'goo'"):
        parse(HEAD + looked.replace("state: go}", "state: goo}"), "m.yaml", CATALOGUE)


def test_lists_go_together_and_loops_are_nested():
    text = """\
targets: {p1: {position: [9, 0, -3]}, p2: {position: [0, 9, -3]}}
dwell: 0.04
initial: all
states:
  all:
    for_each: {pole: [p1, p2], heights: [[5, 8], [6]]}
    initial: levels
    states:
      levels:
        for_each: {height: $heights}
        kind: gps
        behavior: {use: go_to, target: $pole, height: $height}
        transitions: [{to: end, when: done}, {to: skip, event: no}]
      end: {final: true}
    transitions: [{to: home, when: done}]
  home: {kind: land}
"""
    mission = parse(HEAD + text, "m.yaml", CATALOGUE)
    flown = [
        (it.state.behavior.plugin.target, it.state.behavior.plugin.height)
        for it in mission.walk()
        if it.state.kind == "gps"
    ]
    assert flown == [("p1", 5.0), ("p1", 8.0), ("p2", 6.0)]
    assert "all/p1/levels/skipped" in mission.variables
    walk = Walk(chart_of(text))
    assert walk.state == "all/p1/levels/height-1"
    walk.tick("no")
    assert walk.state == "all/p1/levels/height-2"
    walk.tick(done=True)
    walk.tick()
    assert walk.state == "all/p2/levels/height-1"


def test_an_included_file_may_be_the_thing_done_for_each(tmp_path):
    (tmp_path / "visit.yaml").write_text(
        "params: {pole: home}\ninitial: go\nstates:\n"
        "  go: {kind: gps, behavior: {use: go_to, target: $pole},"
        " transitions: [{to: end, when: done}]}\n  end: {final: true}\n"
    )
    mission = POLES[: POLES.index("    retries")] + (
        "    include: visit.yaml\n    with: {pole: $pole}\n"
        "    transitions: [{to: home, when: done}, {to: skip, after: 60}]\n  home: {kind: land}\n"
    )
    (tmp_path / "m.yaml").write_text(HEAD + mission)
    tree = load(tmp_path / "m.yaml", CATALOGUE).by_name()
    assert tree["poles/p3/go"].state.behavior.plugin.target == "p3"
    assert tree["poles/p1"].state.transitions[0].targets == ("poles/p2",)


def test_checks_and_drawing_take_it_as_any_other_chart():
    mission = parse(HEAD + POLES.replace("to: home, when", "to: skip, when"), "m.yaml", CATALOGUE)
    codes = {it.code for it in findings(mission, CATALOGUE)}
    assert {"shadowed-transition", "trap"} <= codes  # `home` is never reached
    assert "poles/p2/go" in mermaid(parse(HEAD + POLES, "m.yaml", CATALOGUE)).replace("__", "/")


@pytest.mark.parametrize(
    ("was", "now", "says"),
    [
        ("{pole: $poles}", "[p1]", "7:15: for_each: expected a mapping (name: list), got a list"),
        ("{pole: $poles}", "{pole: p1}", "7:22: for_each: 'pole': expected a list of what $pole"),
        ("{pole: $poles}", "{pole: []}", "got an empty list"),
        ("{pole: $poles}", "{pole: $poles, at: [1]}", "must be of one length"),
        ("{pole: $poles}", "{pole: $poles, at: [1, 2, 3]}", "'at' is never used; write $at"),
        ("retries: 1", "retries: many", "8:14: retries: expected a whole number from 0 up"),
        ("retries: 1", "summary: no retries", "to: retry needs 'retries: N' beside 'for_each'"),
        ("target: $pole", "target: $post", "unknown parameter $post"),
        ("[p1, p2, p3]", "[p1, p2, p4]", "unknown target 'p4'"),
    ],
)
def test_what_is_wrong_with_a_loop_is_said_where_it_stands(was, now, says):
    with pytest.raises(FileError) as error:
        parse(POLES.replace(was, now, 1), "m.yaml", CATALOGUE)
    assert says in str(error.value)
