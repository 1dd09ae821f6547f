from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from documents import document

from missionkit.chart.checks import findings
from missionkit.chart.drawing.mermaid_text import mermaid
from missionkit.chart.drawing.problem_marks import marks
from missionkit.chart.drawing.svg_chart import svg
from missionkit.chart.load import load, parse
from missionkit.chart.model.guard_expressions import All
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_contracts import fulfilled
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.errors import Level, Place, Problem

TEXT = """\
missionkit: 1
mission: small
targets: {a-b: {position: [1, 2, -3]}}
failsafes:
  - {name: link, when: link_lost, unknown: ignore, for: 2, to: land-now}
initial: idle
states:
  idle:
    kind: idle
    transitions:
      - {to: fly, when: {all: [ready, {not: done}]}, for: 1.5}
      - {to: idle, event: again, after: 3}
  fly: {kind: gps, behavior: {use: go_to, target: a-b}}
  land-now: {kind: land}
"""


@pytest.fixture
def mission(catalogue: Catalogue) -> Mission:
    return parse(TEXT, "m.yaml", catalogue)


def test_mermaid(mission: Mission):
    assert mermaid(mission) == (
        "stateDiagram-v2\n"
        "    [*] --> s0_idle\n"
        '    state "idle" as s0_idle\n'
        "    s0_idle : idle, hold\n"
        "    s0_idle --> s1_fly : ready and not done for 1.5 s\n"
        "    s0_idle --> s0_idle : on again and after 3 s\n"
        '    state "fly" as s1_fly\n'
        "    s1_fly : gps, go to a-b\n"
        '    state "land-now" as s2_land_now\n'
        "    s2_land_now : land, land\n"
        "    note left of s0_idle\n"
        "        in every flying state:\n"
        "        link#58; link lost for 2 s, not when unknown → land-now\n"
        "    end note\n"
        "    style s0_idle fill:#e5e7eb,stroke:#555,color:#111\n"
        "    style s1_fly fill:#cfe3fb,stroke:#555,color:#111\n"
        "    style s2_land_now fill:#f5dcc9,stroke:#555,color:#111\n"
    )


def texts(picture: str) -> list[str]:
    root = ET.fromstring(picture)  # noqa: S314  our own picture
    return ["".join(text.itertext()) for text in root.iter("{http://www.w3.org/2000/svg}text")]


def test_the_picture_shows_states_guards_and_failsafes(mission: Mission):
    shown = texts(svg(mission))
    assert {"small", "idle", "fly", "land-now", "gps: go to a-b"} <= set(shown)
    assert {"ready and not done for 1.5", "on again and after 3 s"} <= set(shown)
    assert shown[-1] == "link: link lost for 2 s, not when unknown → land-now"


def test_the_picture_escapes_what_the_mission_says(catalogue: Catalogue):
    text = TEXT.replace("mission: small", "mission: small\nsummary: a <b> & c")
    assert "a <b> & c" in texts(svg(parse(text, "m.yaml", catalogue)))


def test_the_example_is_drawn_the_same_every_time(example: Path, catalogue: Catalogue):
    mission = load(example, catalogue)
    picture = svg(mission)
    assert picture == svg(mission)
    assert picture.count("marker-end") == 1 + sum(
        len(state.transitions) for state in mission.states.values()
    )
    assert "marked" not in picture.partition("</style>")[2]


NESTED = document("docs/reference/charts.md").split("```yaml\n")[1].partition("```")[0]


def test_states_inside_are_drawn_inside(catalogue: Catalogue):
    picture = svg(parse(NESTED, "m.yaml", catalogue))
    assert picture.count('class="box around"') == 1
    assert picture.count('class="box around region"') == 2
    assert picture.count("<circle") == 3  # the chart, fly, watch
    assert {"2 states together", "shallow history", "the first time"} <= set(texts(picture))


def problems(mission: Mission) -> list[Problem]:
    idle, fly = mission.states["idle"], mission.states["fly"]
    when = idle.transitions[0].when
    assert isinstance(when, All)
    return [
        Problem(idle.transitions[1].place("after"), "late: <then>; done"),
        Problem(fly.place("kind"), "trap", Level.WARNING, "trap"),
        Problem(when.parts[1].place, "never"),
        Problem(mission.failsafes[0].place("when"), "of a failsafe"),
        Problem(Place("m.yaml", 11, 21), "at a key of a transition"),
    ]


def test_problems_belong_to_the_state_or_transition_they_stand_in(mission: Mission):
    found = marks(mission, problems(mission))
    assert found.states == {"fly": (2,)}
    assert found.ways == {("idle", 1): (1,), ("idle", 0): (3, 5)}
    assert found.lines[1] == "[2] warning, line 13: trap"


def test_problems_are_drawn_in_red_and_listed(mission: Mission):
    picture = svg(mission, marks(mission, problems(mission)))
    assert picture.count('class="arrow marked"') == 2
    assert picture.count('class="box marked"') == 1
    shown = texts(picture)
    assert {"fly [2]", "[1] on again and after 3 s"} <= set(shown)
    at = shown.index("Problems, marked in red:")
    assert shown[at + 1] == "[1] error, line 12: late: <then>; done"
    assert shown[at + 4] == "[4] error, line 5: of a failsafe"


def test_problems_are_numbered_in_mermaid(mission: Mission):
    drawn = mermaid(mission, marks(mission, problems(mission)))
    for line in (
        '    state "fly [2]" as s1_fly',
        "    s0_idle --> s0_idle : [1] on again and after 3 s",
        "    note right of s0_idle\n        problems:\n"
        "        [1] error, line 12#58; late#58; #60;then#62;#59; done",
        "    style s1_fly fill:#cfe3fb,stroke:#c81e1e,stroke-width:3px,color:#111",
    ):
        assert f"{line}\n" in drawn


def test_what_a_contract_added_has_no_place(mission: Mission, catalogue: Catalogue):
    nowhere = [Problem(Place("", 1, 1), "somewhere")]
    assert marks(fulfilled(mission, catalogue), nowhere).ways == {}


def test_a_transition_over_several_lines_is_marked_too(catalogue: Catalogue):
    inline = "{to: fly, when: {all: [ready, {not: done}]}, for: 1.5}"
    block = "to: fly\n        when:\n          all:\n            - ready\n            - done"
    mission = parse(TEXT.replace(inline, block), "m.yaml", catalogue)
    when = mission.states["idle"].transitions[0].when
    assert isinstance(when, All)
    assert marks(mission, [Problem(when.parts[1].place, "never")]).ways == {("idle", 0): (1,)}


TWICE = """\
missionkit: 1
mission: twice
initial: first
states:
  first: {include: part.yaml, with: {wait: 20}, transitions: [{to: second, event: go}]}
  second: {include: part.yaml, with: {wait: 3}, transitions: [{to: land, event: go}]}
  third: {include: outer.yaml, transitions: [{to: land, event: go}]}
  land: {kind: land}
"""
PART = """\
params: {wait: 5}
initial: near
states:
  near:
    kind: custom
    transitions: [{to: low, when: link_lost, for: 8}, {to: near, after: $wait}]
  low: {kind: custom}
"""
OUTER = "initial: in\nstates: {in: {include: part.yaml, with: {wait: 2}}}\n"


@pytest.fixture
def twice(tmp_path: Path, catalogue: Catalogue) -> Mission:
    (tmp_path / "part.yaml").write_text(PART)
    (tmp_path / "outer.yaml").write_text(OUTER)
    (tmp_path / "m.yaml").write_text(TWICE)
    return load(tmp_path / "m.yaml", catalogue)


def test_marks_sit_on_the_instance_of_an_included_file_that_has_the_problem(
    twice: Mission, catalogue: Catalogue
):
    found = findings(twice, catalogue)
    never = [n for n, it in enumerate(found, 1) if it.code == "contradictory-timers"]
    named = [found[n - 1].message.split("'")[1] for n in never]
    assert sorted(named) == ["second/near", "third/in/near"]
    marked = marks(twice, found)
    ways = {way: [n for n in numbers if n in never] for way, numbers in marked.ways.items()}
    assert {way for way, numbers in ways.items() if numbers} == {(it, 0) for it in named}
    assert all("part.yaml line 6:" in marked.lines[n - 1] for n in never)


def test_a_problem_of_every_instance_is_listed_once_and_marked_on_each(
    twice: Mission, catalogue: Catalogue
):
    near = [twice.by_name()[f"{name}/near"].state for name in ("first", "second", "third/in")]
    problem = Problem(Place(near[0].place().file, 6, 19), "the same in all")
    assert marks(twice, [problem]).ways == {
        (f"{name}/near", 0): (1,) for name in ("first", "second", "third/in")
    }
    assert [it.place().inside for it in near] == ["first", "second", "third/in"]


def test_requirements_stand_on_the_diagram(catalogue: Catalogue):
    required = "requirements: [{name: ends, existence: {in: land-now}, within: 900}]\n"
    mission = parse(TEXT + required, "m.yaml", catalogue)
    sentence = "within 900 s, it happens that land-now is active"
    note = mermaid(mission).partition("requirements:")[2]
    assert sentence in note.partition("end note")[0]
    assert ">Requirements:</text>" in svg(mission)
    assert sentence in svg(mission)
