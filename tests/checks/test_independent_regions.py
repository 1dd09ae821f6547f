"""Parallel regions that have nothing to do with each other are explored apart."""

from __future__ import annotations

import pytest

from missionkit.chart.checks import findings
from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.checks.exploration.independent_regions import independent
from missionkit.chart.checks.exploration.search import Search, explore
from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.load import parse
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_contracts import fulfilled
from missionkit.chart.plugin_catalogue import Catalogue

HEAD = """\
missionkit: 1
mission: regions
camera: {use: none}
variables: {n: {initial: 0, max: 2}, m: {initial: 0, max: 2}}
failsafes:
  - {name: battery, when: {use: battery_below, floor: 0.2}, to: land}
  - {name: link, when: link_lost, to: land}
  - {name: lost, when: estimate_bad, to: land}
initial: work
states:
  land: {kind: land}
  work:
    kind: logic
    parallel: true
    transitions: [{to: land, event: stop}]
    states:
"""
REGION = """\
      r{0}:
        kind: logic
        initial: a{0}
        states:
          a{0}: {{kind: logic, transitions: [{{to: b{0}, after: 5}}]}}
          b{0}: {{kind: logic, transitions: [{{to: a{0}, when: {1}}}, {{to: c{0}, event: {2}}}]}}
          c{0}: {{kind: logic, {4}, transitions: [{{to: {3}, after: 2}}]}}
"""
LOW = "{use: battery_below, floor: 0.5}"
QUIET = "entry: []"


def region(
    number: int, when: str = LOW, event: str = "go", to: str = "", entry: str = QUIET
) -> str:
    return REGION.format(number, when, event, to or f"a{number}", entry)


def explored(text: str, catalogue: Catalogue) -> tuple[Mission, ExploredChart]:
    mission = parse(text, "m.yaml", catalogue)
    flying = catalogue.flying(mission.vehicle.use)
    return mission, ExploredChart(AnalysedChart(fulfilled(mission, flying), flying))


def test_what_is_found_apart_is_what_is_found_together(catalogue: Catalogue):
    never = region(1, when="{all: [{in: a1}, {in: b1}]}")
    _, chart = explored(HEAD + region(0) + never, catalogue)
    assert independent(chart) == ("work", ("r0", "r1"))
    together, apart = Search(chart).run(), explore(chart)
    assert together.complete
    assert apart.complete
    assert apart.taken.keys() == together.taken.keys()
    assert apart.reached.keys() == together.reached.keys()
    assert apart.ticks < together.ticks


def test_many_regions_are_proved(catalogue: Catalogue):
    mission, chart = explored(HEAD + "".join(map(region, range(12))), catalogue)
    assert explore(chart).complete
    assert "unproven" not in {problem.code for problem in findings(mission, catalogue)}


@pytest.mark.parametrize(
    "other",
    [
        region(1, when="{in: b0}"),
        region(1, when="{use: elapsed, longer_than: 3}"),
        region(1, when="{variable: n, at_least: 1}"),
        region(1, event="done.state.r0"),
        region(1, to="land"),
        region(1, to="r1"),
        region(1, to="b0"),
        region(1, entry="entry: [{raise: stop}]"),
        region(1, entry="entry: [{raise: go}]"),
        region(1, entry="entry: [{assign: {n: 1}}]"),
        region(1, entry="invariant: {holds: link_lost, exit: a1}"),
    ],
)
def test_regions_that_have_to_do_with_each_other_are_not(other: str, catalogue: Catalogue):
    counting = region(0, entry="entry: [{assign: {n: {add: 1}}}]")
    alone = region(1, entry="entry: [{assign: {m: {add: 1}}}]")
    assert independent(explored(HEAD + counting + alone, catalogue)[1]) is not None
    assert independent(explored(HEAD + counting + other, catalogue)[1]) is None
