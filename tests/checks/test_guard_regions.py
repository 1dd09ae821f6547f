"""Where guards hold, as the checks read them."""

from __future__ import annotations

import pytest

from missionkit.chart.checks import findings
from missionkit.chart.checks.landing_guarantee import escapes
from missionkit.chart.load import parse
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import Catalogue

HEAD = """\
missionkit: 1
mission: small
targets: {t: {position: [0, 0, -5]}}
perception: [{use: aruco, target: t, id: 1, size: 0.4}]
variables: {n: 0, fixed: 1}
guards:
  latch: {hysteresis: {use: within, of: t, radius: 5}, enter: 4, exit: 6}
  seen: {use: aruco_confidence, target: t, enter: 0.7, exit: 0.5}
failsafes:
  - {name: battery, when: {use: battery_below, floor: 0.2}, to: land}
"""


def mission(states: str, catalogue: Catalogue) -> Mission:
    text = f"{HEAD}initial: up\nstates:\n{states}  land: {{kind: land}}\n"
    return parse(text, "m.yaml", catalogue)


def codes(guard: str, catalogue: Catalogue) -> set[str]:
    way = f"{{to: land, when: {guard}, do: [{{assign: {{n: {{add: 1}}}}}}]}}"
    states = f"  up: {{kind: custom, transitions: [{way}, {{to: land, after: 9}}]}}\n"
    found = findings(mission(states, catalogue), catalogue)
    others = ("unsafe", "never-fires")  # of which guard regions alone say nothing
    return {problem.code for problem in found if not problem.code.startswith(others)}


@pytest.mark.parametrize(
    "guard",
    [
        "{all: [latch, {not: {use: within, of: t, radius: 5.5}}]}",  # until it ends
        "{all: [{not: latch}, {use: within, of: t, radius: 4.5}]}",  # until it begins
        "{all: [seen, {not: {use: target_seen, target: t}}]}",
        "{all: [{variable: n, at_least: 7}, {not: {variable: n, equals: 8}}]}",
        "{any: [{variable: n, below: 0}, {variable: n, above: 3}]}",
        "{variable: fixed, equals: 1}",
        "{not: {all: [seen, latch]}}",
    ],
)
def test_what_may_hold_is_not_called_dead(guard, catalogue):
    assert codes(guard, catalogue) == set()


@pytest.mark.parametrize(
    "guard",
    [
        "{all: [latch, {not: {use: within, of: t, radius: 6}}]}",
        "{all: [{not: latch}, {use: within, of: t, radius: 3.9}]}",
        "{all: [seen, {not: seen}]}",
        "{all: [{variable: n, above: 7}, {variable: n, below: 8}]}",  # whole numbers
        "{variable: n, below: 0}",
        "{variable: fixed, equals: 2}",
        "{not: {any: [seen, {not: seen}]}}",
        "{in: land}",
        "done",
    ],
)
def test_what_cannot_hold_is_called_dead(guard, catalogue):
    assert codes(guard, catalogue) == {"never-true"}


CIRCLE = """\
    states:
      one: {kind: custom, transitions: [{to: two, when: plugin_failed}, {to: two, after: 20}]}
      two: {kind: custom, transitions: [{to: one, after: 30}]}
"""


def bounds(states: str, catalogue: Catalogue) -> dict[str, float | None]:
    found = escapes(mission(states, catalogue), catalogue)
    return {it.state: it.seconds for it in found if it.danger == "link"}


def test_a_timer_around_bounds_a_circle_inside(catalogue):
    around = "  up:\n    initial: one\n"
    timed = f"{around}    transitions: [{{to: land, after: 100}}]\n{CIRCLE}"
    assert bounds(timed, catalogue) == {"one": 100.0, "two": 100.0}
    event = f"{around}    transitions: [{{to: land, event: enough}}]\n{CIRCLE}"
    assert bounds(event, catalogue) == {"one": None, "two": None}


def test_the_bound_is_the_worst_way_an_opponent_finds(catalogue):
    states = """\
  up: {kind: custom, transitions: [{to: long, when: seen}, {to: short, after: 10}]}
  short: {kind: custom, transitions: [{to: land, after: 5}]}
  long: {kind: custom, transitions: [{to: land, after: 50}]}
"""
    assert bounds(states, catalogue) == {"up": 60.0, "short": 5.0, "long": 50.0}
