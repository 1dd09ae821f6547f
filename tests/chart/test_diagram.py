from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from missionkit.chart.catalogue import Catalogue
from missionkit.chart.diagram import mermaid
from missionkit.chart.load import load, parse
from missionkit.chart.model import Mission
from missionkit.chart.picture import svg

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
