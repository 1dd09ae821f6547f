"""Regions of the guards about Markov chains and decision processes, in the checks."""

from __future__ import annotations

import pytest
from documents import MINIMAL

from missionkit.chart.checks import findings
from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.errors import FileError

FLYING = "    transitions: [{to: home, after: 9}]\n  home"
LANDS = "failsafes: [{name: lost, when: estimate_bad, to: land}]\n"
CHAIN = "use: markov_steady_state, states: [far, near], of: near"
POLICY = """\
  go-home:
    use: mdp_policy
    action: leave
    states: [watch, home, late]
    actions:
      stay: {leads: {watch: {late: 0.5, home: rest}}}
      leave: {leads: {watch: home}, cost: 2}
    final: {late: COST}
"""


def codes(guards, transitions):
    text = MINIMAL.replace(FLYING, f"    transitions: {transitions}\n  home")
    mission = parse(f"{text}{LANDS}guards:\n{guards}", "m.yaml", builtin())
    return [(it.code, it.message) for it in findings(mission, builtin())]


def test_a_probability_that_two_states_cannot_reach_is_called_out():
    guards = f"  g: {{{CHAIN}, matrix: [[rest, 0.1], [battery, rest]], at_least: LIMIT}}\n"
    way = "[{to: home, when: g}, {to: home, after: 9}]"
    # into near 0.1; out of it the battery, at most 1: between 0.1 / 1.1 and 1
    assert codes(guards.replace("LIMIT", "0.5"), way) == []
    ((code, message),) = codes(guards.replace("at_least: LIMIT", "at_most: 0.09"), way)
    assert code == "never-true"
    assert "'g' can never hold" in message


def test_two_limits_of_one_chain_exclude_each_other():
    matrix = "matrix: [[rest, battery], [0.1, rest]]"
    guards = (
        f"  a: {{{CHAIN}, {matrix}, at_least: 0.6}}\n  b: {{{CHAIN}, {matrix}, at_most: 0.5}}\n"
    )
    way = "[{to: home, when: {all: [a, b]}}, {to: home, after: 9}]"
    assert [code for code, _ in codes(guards, way)] == ["never-true"]


@pytest.mark.parametrize(("cost", "dead"), [("100", False), ("0", True)])
def test_a_policy_that_never_chooses_the_action_here_is_called_out(cost, dead):
    way = "[{to: home, when: go-home}, {to: home, after: 9}]"
    found = [code for code, _ in codes(POLICY.replace("COST", cost), way)]
    assert ("never-true" in found) is dead


def test_a_target_that_no_detector_looks_for_is_called_out():
    guards = f"  g: {{{CHAIN}, matrix: [[rest, confidence of pole], [0.1, rest]], at_least: 0.5}}\n"
    way = "[{to: home, when: g}, {to: home, after: 9}]"
    assert "no-detector" in [code for code, _ in codes(guards, way)]


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("{variable: trie}", "unknown variable 'trie'"),
        ("{guard: neer}", "unknown guard 'neer'"),
        ("confidence of pol", "unknown target 'pol'; did you mean 'pole'"),
        ("{guard: g}", "guard 'g' refers to itself: g -> g"),
        ("{variable: word}", "the guard reads word as a number: it is a string"),
    ],
)
def test_names_that_do_not_fit_are_refused(entry, message):
    guards = f"  g: {{{CHAIN}, matrix: [[rest, {entry}], [0.1, rest]], at_least: 0.5}}\n"
    text = f"{MINIMAL}variables: {{tries: 0, word: yes}}\nguards:\n{guards}"
    with pytest.raises(FileError, match=message):
        parse(text, "m.yaml", builtin())
