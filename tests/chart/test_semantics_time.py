"""Everything that lasts: for, after, dwell."""

from __future__ import annotations

import pytest
from stepping import TICK, Walk


def walk_of(*transitions: str, top: str = "dwell: 0\n") -> Walk:
    return Walk(
        f"initial: x\n{top}states:\n  x:\n    kind: custom\n    transitions:\n"
        + "".join(f"      - {one}\n" for one in transitions)
        + "  y: {kind: custom, transitions: [{to: x, event: back}]}\n  land: {kind: land}\n"
    )


def test_after_counts_from_entry():
    walk = walk_of("{to: y, after: 0.5}")
    walk.run(0.7)
    assert walk.trace == [(0.5, "x", "y", "after 0.5 s")]
    walk.tick("back")
    walk.run(2.0)
    assert walk.went() == [(0.5, "y"), (0.75, "x"), (1.25, "y")]


def test_for_counts_from_when_the_guard_began_to_hold():
    walk = walk_of("{to: y, when: a, for: 0.5}")
    walk.run(0.2)
    walk.run(2.0, "a")  # holds from 0.25 on
    assert walk.trace == [(0.75, "x", "y", "when a for 0.5 s")]


@pytest.mark.parametrize("gap", ["", "a?"])
def test_for_restarts_when_the_guard_stops_holding_even_once(gap):
    walk = walk_of("{to: y, when: a, for: 0.5}")
    walk.run(0.5, "a")
    walk.tick(gap)
    walk.run(2.0, "a")
    assert walk.went() == [(1.1, "y")]


def test_for_restarts_on_re_entry():
    walk = walk_of("{to: y, when: a, for: 0.3}")
    walk.run(0.35, "a")
    walk.tick("a", "back")
    walk.run(2.0, "a")
    assert walk.went() == [(0.35, "y"), (0.4, "x"), (0.75, "y")]


def test_all_that_a_transition_names_must_be_fulfilled():
    walk = walk_of("{to: y, when: a, for: 0.2, after: 0.5, event: go}")
    walk.tick("a", "go")
    walk.run(0.4, "a")
    walk.tick("a", "go")  # held for 0.4 s, but entered only 0.45 s ago
    walk.tick("a")
    walk.tick("go")
    assert walk.trace == []
    walk.run(0.85, "a")
    walk.tick("a", "go")
    assert walk.trace == [(0.9, "x", "y", "when a for 0.2 s, after 0.5 s, on go")]


def test_an_event_lasts_one_tick():
    walk = walk_of("{to: y, event: go, after: 0.2}")
    walk.tick("go")
    walk.run(1.0)
    assert walk.trace == []


def test_transitions_wait_for_the_dwell_of_two_seconds():
    walk = walk_of("{to: y, when: a}", top="")
    walk.run(1.95, "a")
    assert walk.state == "x"
    walk.run(2.0, "a")
    assert walk.went() == [(2.0, "y")]


def test_an_event_does_not_wait_for_the_dwell():
    walk = walk_of("{to: y, event: go}", top="")
    walk.tick("go")
    assert walk.went() == [(0.05, "y")]


def test_holding_during_the_dwell_counts():
    walk = walk_of("{to: y, when: a, for: 1.5}", top="")
    walk.run(2.5, "a")
    assert walk.went() == [(2.0, "y")]


def test_an_emergency_does_not_wait_for_the_dwell():
    walk = walk_of("{to: y, when: a}", "{to: land, when: b, emergency: true}", top="")
    walk.run(0.5, "a")
    walk.tick("a", "b")
    assert walk.trace == [(0.55, "x", "land", "when b")]


def test_a_state_may_have_its_own_dwell():
    walk = Walk("""\
initial: x
states:
  x: {kind: custom, dwell: 0.2, transitions: [{to: y, when: a}]}
  y: {kind: custom, transitions: [{to: x, when: a}]}
  land: {kind: land}
""")
    walk.run(2.6, "a")
    assert walk.went() == [(0.2, "y"), (2.2, "x"), (2.4, "y")]


def test_the_rounding_of_times_costs_no_tick():
    walk = walk_of("{to: y, after: 0.3}")
    assert 18 * TICK - 12 * TICK < 0.3
    walk.run(0.55)
    walk.tick("back")
    walk.run(2.0)
    assert walk.went() == [(0.3, "y"), (0.6, "x"), (0.9, "y")]


def test_after_goes_on_in_a_state_around_while_the_states_inside_change():
    walk = Walk("""\
initial: outer
dwell: 0
states:
  outer:
    kind: custom
    initial: x
    transitions: [{to: land, after: 0.5}]
    states:
      x: {kind: custom, transitions: [{to: y, after: 0.2}]}
      y: {kind: custom, transitions: [{to: x, after: 0.2}]}
  land: {kind: land}
""")
    walk.run(1.0)
    assert walk.went() == [(0.2, "y"), (0.4, "x"), (0.5, "land")]
