"""What is known of each requirement before the flight."""

from __future__ import annotations

from pathlib import Path

import pytest

from missionkit.chart.checks.broken_requirements import standings
from missionkit.chart.load import load, parse
from missionkit.chart.plugin_catalogue import Catalogue

FOLDER = Path(__file__).parent
WORDS = {"Proved": "proved", "Open": "open", "Refuted": "refuted"}
EXPECTED = {
    "looked-first": "refuted",
    "at-most-once": "refuted",
    "at-most-twice": "proved",
    "looks-charged": "proved",
    "works-full": "open",
    "never-back": "proved",
    "soon-home": "open",
    "seen": "refuted",
    "again": "refuted",
    "looks-long": "refuted",
    "enters": "proved",
}
CHART = """\
missionkit: 1
mission: m
camera: {use: none}
dwell: 0
initial: a
states:
  a: {kind: custom, transitions: [{to: b, event: go}, {to: land, after: 5}]}
  b: {kind: custom, transitions: [{to: c, after: 4}, {to: land, event: go}]}
  c: {kind: custom, transitions: [{to: land, after: 1}]}
  land: {kind: land}
requirements:
"""


def known(text: str, catalogue: Catalogue) -> str:
    mission = parse(f"{CHART}  - {{name: it, {text}}}\n", "m.yaml", catalogue)
    return WORDS[standings(mission, catalogue)["it"].partition(" ")[0].rstrip(":")]


def test_each_requirement_of_the_file(catalogue: Catalogue):
    mission = load(FOLDER / "48-requirements.yaml", catalogue)
    found = standings(mission, catalogue)
    assert {name: WORDS[said.partition(" ")[0].rstrip(":")] for name, said in found.items()} == (
        EXPECTED
    )


@pytest.mark.parametrize(
    ("requirement", "expected"),
    [
        ("precedence: {enter: b}, before: {enter: c}", "proved"),
        ("precedence: {enter: c}, before: {enter: c}, within: 3", "proved"),
        ("precedence: {enter: b}, before: {enter: c}, within: 3", "open"),
        ("precedence: {enter: a}, before: {enter: c}, within: 30", "open"),
        ("precedence: {enter: c}, before: {enter: b}", "refuted"),
        ("precedence: {enter: c}, before: {enter: b}, while: {in: c}", "proved"),
        ("never: {in: c}", "refuted"),
        ("never: {in: c}, within: 3", "proved"),
        ("never: {in: c}, after: {in: land}", "proved"),
        ("never: {in: c}, after: {enter: b}, within: 3", "proved"),
        ("never: {in: land}, before: {enter: b}", "refuted"),
        ("never: {in: c}, before: {enter: b}", "proved"),
        ("always: {not: {in: c}}, while: {in: b}", "proved"),
        ("existence: {in: land}", "open"),
        ("existence: {in: c}, within: 3", "refuted"),
        ("existence: {in: b}, after: {in: land}", "refuted"),
        ("existence: {in: b}, after: {in: b}", "proved"),
        ("response: {when: {in: b}, then: {any: [{in: c}, {in: land}]}}", "open"),
        ("response: {when: {in: c}, then: {enter: b}}", "refuted"),
        ("response: {when: {in: c}, then: {enter: b}}, while: {in: a}", "open"),
    ],
)
def test_patterns(requirement: str, expected: str, catalogue: Catalogue):
    assert known(requirement, catalogue) == expected


def test_nothing_is_explored_without_requirements(catalogue: Catalogue):
    text = CHART.removesuffix("requirements:\n")
    assert standings(parse(text, "m.yaml", catalogue), catalogue) == {}
