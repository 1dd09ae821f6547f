"""Mealy outputs: what is said and raised, in which order, and when it is heard."""

from __future__ import annotations

from stepping import Walk

CHART = """\
initial: x
dwell: 0
states:
  x:
    kind: visual
    behavior: {use: servo, target: t}
    exit: [{log: leaving x}, {raise: left}]
    transitions:
      - {to: y, when: a, do: [{log: on the way}, {raise: underway}]}
  y:
    kind: gps
    behavior: {use: go_to, target: t}
    entry: [{log: in y}, {raise: arrived}]
    transitions:
      - {to: z, event: arrived}
      - {to: w, event: underway}
  w: {kind: custom, transitions: [{to: z, event: arrived}]}
  z: {kind: custom, entry: [{raise: arrived}], transitions: [{to: land, event: left}]}
  land: {kind: land}
targets: {t: {position: [1, 2, 3]}}
"""


def test_outputs_come_in_the_order_exit_transition_entry_after_the_mode():
    walk = Walk(CHART)
    fired = walk.tick("a").fired[0]
    assert fired.outputs == (
        *("mode gps", "log leaving x", "raise left", "log on the way", "raise underway"),
        *("log in y", "raise arrived"),
    )


def test_raised_events_are_handled_once_and_in_order():
    walk = Walk(CHART)
    walk.run(1.0, "a")
    assert walk.trace == [
        (0.05, "x", "y", "when a"),
        (0.05, "y", "w", "on underway"),
        (0.05, "w", "z", "on arrived"),
    ]


def test_what_is_raised_inside_comes_before_what_comes_from_outside():
    walk = Walk(CHART)
    walk.tick("a", "left")
    assert walk.state == "land"


def test_every_transition_says_its_mode_first():
    walk = Walk(CHART)
    modes = [fired.outputs[0] for fired in walk.tick("a", "left").fired]
    assert modes == ["mode gps", "mode trajectory", "mode trajectory", "mode none"]


OPENING = """\
initial: x
dwell: 0
states:
  x: {kind: idle, entry: [{log: hello}, {raise: go}], transitions: [{to: y, event: go}]}
  y: {kind: custom}
  land: {kind: land}
"""


def test_the_initial_state_is_entered_at_the_first_tick():
    walk = Walk(OPENING)
    first = walk.tick()
    assert first.entered
    start, left = first.fired
    assert (start.to, start.reason) == ("x", "start")
    assert start.outputs == ("mode none", "log hello", "raise go")
    assert (left.to, left.reason, left.outputs) == ("y", "on go", ("mode trajectory",))


def test_an_initial_state_without_outputs_is_entered_quietly():
    walk = Walk("initial: x\nstates: {x: {kind: idle}, land: {kind: land}}\n")
    decisions = [walk.tick() for _ in range(3)]
    assert [decision.entered for decision in decisions] == [True, False, False]
    assert walk.trace == []


FAILING = """\
initial: x
dwell: 0
variables: {tries: {initial: 0, max: 1}, seen: 0}
states:
  x:
    kind: custom
    entry: [{assign: {tries: {add: 1}}}, {assign: {seen: {add: 1}}}]
    exit: [{assign: {tries: {add: 1}}}, {assign: {seen: {add: 10}}}]
    transitions:
      - {to: x, event: go, do: [{log: on the way}, {assign: {tries: {add: 5}}}, {vehicle: hold}]}
      - {to: y, event: error.execution}
  y: {kind: custom}
  land: {kind: land}
"""


def test_after_an_action_that_fails_the_rest_of_its_block_alone_is_skipped():
    walk = Walk(FAILING)
    walk.tick()
    assert walk.memory.variables == {"tries": 1, "seen": 1}
    decision = walk.tick("go")
    assert walk.memory.variables == {"tries": 1, "seen": 1}  # of exit, of the way, of entry
    assert decision.orders == ()
    assert decision.fired[0].outputs[1:] == (
        *("assign tries add 1", "log on the way", "assign tries add 5", "assign tries add 1"),
    )
    rest = "is not a valid value of tries; it stays 1; the actions after it are skipped"
    assert decision.problems == tuple(f"assign tries: {value} {rest}" for value in (2, 6, 2, 2))
    assert walk.state == "y"
