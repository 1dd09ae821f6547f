"""A mission in sentences: everything it does is said, what was added is marked."""

from __future__ import annotations

from pathlib import Path

import pytest
from documents import document

from missionkit.chart.load import load, parse
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.prose.mission_text import explained
from missionkit.chart.prose.state_text import DEMANDS

NESTED = document("docs/reference/charts.md").split("```yaml\n")[1].partition("```")[0]
EXTRAS = """\
missionkit: 1
mission: extras
variables: {seen: false, height: {initial: 5.0, min: 2, max: 30}}
guards: {near: {all: [{variable: height, below: 4}, {not: done}, {any: [ready, {in: hold}]}]}}
failsafes:
  - {name: link, when: link_lost, for: 2, unknown: ignore, to: land, do: [{vehicle: land}]}
initial: {to: hold, do: [{assign: {seen: {toggle: true}}}]}
dwell: 0
states:
  hold:
    kind: hover
    summary: Waits for the operator
    dwell: 4
    stays: true
    entry: [{log: hello}, {raise: here}]
    exit: [{assign: {height: 3.0}}]
    invariant: {holds: {not: camera_silent}, exit: land}
    transitions:
      - {to: group, event: [go, arm], emergency: true}
      - {when: near, for: 1.5, do: [{assign: {height: {add: -1.0}}}]}
      - {to: hold, after: 0, when: {not: {all: [near, ready]}}}
  group:
    initial: {to: a, do: [{assign: {seen: true}}]}
    transitions: [{to: b, when: done, internal: true}]
    states:
      a: {kind: custom, transitions: [{to: end, after: 2}]}
      b: {kind: custom}
      end: {final: true}
      past: {history: deep, default: b}
  land: {kind: land}
success: {visit: group}
"""


def said(text: str, catalogue: Catalogue) -> dict[str, str]:
    """Return the paragraphs of each topic, in one line; the name of a state is its topic's."""
    topics: dict[str, str] = {}
    name = ""
    for each in explained(parse(text, "m.yaml", catalogue), catalogue):
        if each.topic:
            name = each.text.partition(",")[0]
            topics[name] = each.text
        else:
            topics[name] += ("\n- " if each.item else "\n") + each.text
    return topics


@pytest.mark.parametrize(
    ("topic", "says"),
    [
        ("extras", "The chart has 7 states. It begins in hold, where the chart first toggl"),
        ("Variables", "seen, true or false, begins as false. It changes: at the beginning the "),
        ("Variables", "when group begins the chart sets seen to true. Nothing compares it."),
        ("Variables", "- height, a number, at least 2, at most 30, begins as 5."),
        ("Variables", "on exit from hold the chart sets height to 3; on the way inside hold the "),
        ("Variables", "chart adds -1 to height. It decides the guard near."),
        ("Guards", "near holds when height is below 4, it is not true that the behaviour is done "),
        ("Guards", "and (ready holds or hold is active)."),
        ("Failsafes", "every state that flies: hold, a, b and land."),
        ("Failsafes", "- link: when link lost holds, for 2 s without a break, it goes to land, "),
        (
            "Failsafes",
            "and asks the autopilot to land. It is not taken when the guard is unknown.",
        ),
        ("hold", "Waits for the operator. Its behaviour is hold, as for every state of this kind"),
        ("hold", "On entry the chart logs 'hello' and raises here. On exit the chart sets height"),
        ("hold", "It requires that camera silent does not hold; if not, it leaves for land."),
        ("hold", "It is entered at the very beginning and from hold."),
        ("hold", "It is kept for 4 s at least, instead of the mission's dwell."),
        ("hold", "It may last forever, on purpose."),
        ("hold", "- to group on the event go or arm (does not wait for the dwell)."),
        ("hold", "- not at all, only an action: when near holds, for 1.5 s without a break; the "),
        ("hold", "- to hold when it is not true that near and ready hold and at once."),
        ("group", "Inside it are a, b, end and past, one of them active at a time; it begins in "),
        ("group", "It is left, whatever is active inside it, unless a way out of that is ready:"),
        ("group", "- to b when a final state inside it is active (without leaving the enclosi"),
        ("a", "It is entered at the beginning of group."),
        ("b", "It is entered from group and by the history past."),
        ("b", "It is left only by transitions out of group, failsafes and the pilot."),
        ("end", "end, a final state of group\nThe enclosing state is done once it is entered."),
        ("past", "It leads to the innermost states of group that were active last; before group "),
        ("land", "It is entered by the broken invariant of hold and by the failsafe link."),
        ("land", "The mission ends here, on the ground."),
        ("Success", "The mission has succeeded when group was entered, and it lands undamaged"),
    ],
)
def test_everything_is_reported(catalogue, topic, says):
    assert says in said(EXTRAS, catalogue)[topic]


@pytest.mark.parametrize(
    ("topic", "says"),
    [
        ("Failsafes", "None: only what the states themselves say, and the default failsafes"),
        ("work", "Inside it are fly and watch, all active together."),
        ("work", "- to home when all its regions are done."),
        ("fly", "It is entered with work. It has no transitions of its own."),
        ("out", "Its kind requires that the position of its target is known; broken for 1 s, it "),
        ("out", "it leaves for hover."),
        ("out", "- to hover when goal unreachable holds (added: default failsafe unreachable of"),
        ("again", "- to home when tries is at least 3.\n- to out after 5 s in it."),
        ("back", "It leads to the state directly inside fly that was active last; before fly wa"),
        ("hover", "hover, of kind hover, added: default failsafes lead to it"),
        ("hover", "It is entered from out and by the broken invariant of out."),
    ],
)
def test_a_tree_is_described_with_the_additions_of_its_kinds(catalogue, topic, says):
    assert says in said(NESTED, catalogue)[topic]


def test_only_what_was_added_is_called_so(catalogue):
    added = [line for text in said(NESTED, catalogue).values() for line in text.splitlines()]
    added = [line for line in added if "added: default failsafe" in line]
    assert [line.partition(" when")[0] for line in added] == [
        "- to hover",
        "- to down",
        "hover, of kind hover, added: default failsafes lead to it",
    ]


def test_states_inside_stand_deeper(catalogue):
    every = explained(parse(NESTED, "m.yaml", catalogue), catalogue)
    depths = {each.text.partition(",")[0]: each.depth for each in every if each.topic}
    assert [depths[name] for name in ("work", "fly", "out", "home")] == [0, 1, 2, 0]


def test_the_example_says_every_state_and_is_the_same_every_time(example: Path, catalogue):
    mission = load(example, catalogue)
    first, again = (list(explained(mission, catalogue)) for _ in range(2))
    assert first == again
    topics = [each.text.partition(",")[0] for each in first if each.topic]
    assert topics[4:-3] == [*mission.states, "hover"]


def test_the_control_of_each_mode_that_is_flown_is_described(catalogue):
    every = explained(parse(NESTED, "m.yaml", catalogue), catalogue)
    said = [each.text for each in every if "gain margin" in each.text]
    assert said[0].startswith("gps, level: it comes to rest: the slowest pole, 0.986, falls to 1/e")
    assert not any(text.startswith("visual") for text in said)


def test_every_kinds_invariant_has_a_description(catalogue):
    formulas = {kind.invariant.says for kind in catalogue.kinds.values() if kind.invariant}
    assert formulas == set(DEMANDS)
