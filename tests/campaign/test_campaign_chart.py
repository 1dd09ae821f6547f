"""The chart with its flights drawn over it: real flights through a chart with regions."""

from __future__ import annotations

import re
from collections import Counter
from xml.etree import ElementTree as ET

import pytest
from campaigns import row

from missionkit.campaigns.chart_coverage import countable, coverage, unflown
from missionkit.campaigns.chart_notes import notes
from missionkit.campaigns.flown_chart import charted
from missionkit.campaigns.markov_chain import estimate
from missionkit.campaigns.run_row import Case, RunOrder
from missionkit.campaigns.single_run import fly, loaded
from missionkit.campaigns.visit_log import parts
from missionkit.chart.drawing.mermaid_text import mermaid
from missionkit.chart.drawing.svg_chart import svg

CHART = """\
missionkit: 1
mission: regions
success: {visit: idle}
params: {wait: 3}
camera: {use: none}
targets: {pole: {position: [4, 0, -3]}}
failsafes:
  - {name: link, when: {use: link_lost, longer_than: 3.0}, to: land}
  - {name: weak, when: {use: battery_below, floor: 0.1}, to: land}
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 3}
    transitions: [{to: work, when: done}]
  work:
    parallel: true
    transitions: [{to: home, event: back}]
    states:
      fly:
        initial: out
        states:
          out:
            kind: custom
            behavior: {use: go_to, target: pole}
            transitions:
              - {to: pause, after: 2}
              - {to: pause, after: 60}
          pause:
            kind: custom
            behavior: hold
            transitions: [{to: out, after: $wait}]
      watch:
        initial: young
        states:
          young: {kind: logic, transitions: [{to: old, after: 8, do: [{raise: back}]}]}
          old: {kind: logic}
  home:
    kind: custom
    behavior: {use: go_to, target: home, height: 3}
    transitions: [{to: land, when: done}]
  land: {kind: land}
"""


@pytest.fixture(scope="module")
def order(tmp_path_factory):
    path = tmp_path_factory.mktemp("regions") / "regions.yaml"
    path.write_text(CHART)
    return RunOrder(str(path), {}, (), ("link_lost@pause+9",))


@pytest.fixture(scope="module")
def calm(order):
    return fly(order._replace(faults=()), Case(0, 0, 1, {}))


@pytest.fixture(scope="module")
def alarmed(order):
    return fly(order, Case(1, 0, 2, {}))


@pytest.fixture(scope="module")
def chart(order):
    mission, catalogue, _, _ = loaded(order, {})
    return charted(mission, catalogue)


@pytest.fixture(scope="module")
def over(chart, calm, alarmed):
    rows = [calm, alarmed, row(2, "crash", visits=(("idle", 4.0),), entries={"idle": 1}, ways={})]
    return notes(chart, coverage(rows), estimate(rows), "as written")


def texts(picture):
    root = ET.fromstring(picture)  # noqa: S314  our own picture
    return ["".join(text.itertext()) for text in root.iter("{http://www.w3.org/2000/svg}text")]


def test_every_state_is_entered_once_more_than_it_is_left(calm, alarmed):
    """Of states that command: by a way of theirs, of one around them, or with the flight's end."""
    for flown in (calm, alarmed):
        visits = Counter(state for state, _ in flown.visits)
        assert {state: flown.entries[state] for state in visits} == visits
        for state in ("idle", "home", "land"):
            left = sum(n for name, n in flown.ways.items() if parts(name)[0] == state)
            ended = flown.visits[-1][0] == state
            assert flown.entries.get(state, 0) == left + ended
    assert [calm.entries[it] for it in ("work", "fly", "watch", "young", "old")] == [1] * 5
    assert calm.times["work"] == pytest.approx(calm.times["fly"])


def test_the_ways_of_a_row_are_those_of_its_chart_or_failsafes(chart, calm, alarmed):
    known = set(chart.ways.values())
    assert set(calm.ways) <= known
    (strange,) = set(alarmed.ways) - known
    assert parts(strange) == (alarmed.visits[-2][0], "land", "failsafe link")


def test_two_transitions_between_the_same_states_are_distinguished(over):
    early, late = over.ways["out", 0], over.ways["out", 1]
    assert not early.pale
    assert (late.pale, late.lines) == (True, ("never taken",))


def test_counts_of_the_flights_are_drawn_on_the_chart(over):
    assert over.states["idle"].lines[0] == "in 100 % of flights"
    assert over.states["idle"].lines[2] == "66.7 % succeed, 33.3 % crash"
    assert over.states["work"].lines[0] == "in 66.7 % of flights"
    assert over.states["work"].lines[2] == "100 % succeed"
    assert over.ways["idle", 0].lines == ("2 times, 66.7 %",)
    assert over.ways["idle", 0].weight == pytest.approx(2 / 3)
    assert over.ways["work", 0].lines == ("1 time, 50.0 %",)
    assert over.failsafes["link"].lines == ("1 time",)
    assert over.failsafes["weak"].lines == ("never taken",)
    assert [(it.name, it.lines[0]) for it in over.ends] == [
        ("success", "2 flights, 66.7 %"),
        ("crash", "1 flight, 33.3 %"),
    ]


def test_counted_and_chain_stand_side_by_side_where_they_differ(chart):
    """All who came to home by a stay in fly succeeded, but land mixes them with the others."""
    long = {"idle": 1, "home": 1, "land": 1}
    rows = [
        row(0, visits=(("idle", 1.0), ("home", 1.0), ("land", 1.0)), entries=long),
        row(1, "crash", visits=(("idle", 1.0), ("land", 1.0)), entries={"idle": 1, "land": 1}),
    ]
    over = notes(chart, coverage(rows), estimate(rows), "x")
    assert over.states["home"].lines[2:] == (
        "100 % succeed",
        "chain: 50.0 % succeed, 50.0 % crash",
    )
    assert over.states["land"].lines[2:] == ("50.0 % succeed, 50.0 % crash",)


def test_states_and_transitions_never_flown_are_listed(chart, calm, alarmed):
    missed = list(unflown(chart, coverage([alarmed])))
    assert [it.name for it in missed if it.what == "state"] == ["old", "home"]
    assert ("failsafe", "weak", 1) in missed
    by_name = {it.name: it.chances for it in missed if it.what == "transition"}
    assert by_name["home → land, when done"] == 0
    assert by_name["out → pause, after 60 s"] == alarmed.entries["out"]
    both = list(unflown(chart, coverage([calm, alarmed])))
    assert [it.name for it in both] == ["out → pause, after 60 s", "weak"]


def test_the_picture_shows_what_was_never_flown_pale_and_failsafes_dashed(chart, over):
    picture = svg(chart.mission, overlay=over, key="k-")
    assert picture.count('class="arrow pale"') == 1
    assert picture.count('class="arrow dashed"') == 1
    assert {'class="box good"', 'class="box bad"'} <= set(re.findall(r'class="box \w+"', picture))
    shown = texts(picture)
    assert {"failsafe link", "2 times, 66.7 %", "never taken", "1 flight, 33.3 %"} <= set(shown)
    assert "3 simulated flights, as written." in shown
    assert any(it.endswith("→ land: never taken") for it in shown)
    tips = set(re.findall(r"url\(#([\w-]+)\)", picture))
    assert tips <= set(re.findall(r'<marker id="([\w-]+)"', picture))
    assert all(tip.startswith("k-") for tip in tips)


def test_all_boxes_stand_inside_the_picture(chart, over):
    root = ET.fromstring(svg(chart.mission, overlay=over))  # noqa: S314  our own picture
    wide, high = float(root.attrib["width"]), float(root.attrib["height"])
    moved = re.findall(r"translate\(([\d.]+) ([\d.]+)\)", ET.tostring(root, encoding="unicode"))
    (left, top) = map(float, moved[0])
    for box in root.iter("{http://www.w3.org/2000/svg}rect"):
        x, y, w, h = (float(box.attrib.get(it, 0)) for it in ("x", "y", "width", "height"))
        if "box" in box.attrib.get("class", ""):
            assert 0 <= left + x <= left + x + w <= wide
            assert 0 <= top + y <= top + y + h <= high


def test_mermaid_shows_the_same_as_text(chart, over):
    drawn = mermaid(chart.mission, overlay=over)
    assert ": after 60 s#59; never taken\n" in drawn
    assert "s9_land --> [*] : success#59; 2 times, 100 %\n" in drawn
    assert ": failsafe link#59; 1 time, " in drawn
    assert " : in 66.7 % of flights\n" in drawn
    assert '    state "work#59; in 66.7 % of flights#59; ' in drawn


def test_rows_of_older_campaigns_are_reported(calm):
    assert countable([calm, row(1, "hung", visits=())])
    assert not countable([calm, row(1)])
