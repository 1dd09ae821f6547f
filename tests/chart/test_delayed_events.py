"""Events that a chart delays and cancels."""

from __future__ import annotations

from stepping import Walk

from missionkit.chart.semantics.actions_and_events import MOST_DELAYED
from missionkit.engine.resume.restore_chart import fitted
from missionkit.recorder import value_codec

CHART = """\
initial: x
dwell: 0
variables: {wait: 0.5, n: 0}
failsafes: [{name: out, when: b, to: home}]
states:
  x:
    kind: custom
    entry: [ENTRY]
    transitions:
      - {to: y, event: late}
      - {event: soon, do: [{assign: {n: {add: 1}}}]}
      - {event: stop, do: [{cancel: late}]}
  y: {kind: custom}
  home:
    kind: return
    behavior: {use: go_to, target: home, height: 5}
    transitions: [{to: land, event: late}]
  land: {kind: land}
"""


def walk_of(entry: str) -> Walk:
    return Walk(CHART.replace("ENTRY", entry))


def test_a_delayed_event_comes_at_its_time_on_the_mission_clock():
    walk = walk_of("{raise: {event: late, after: 0.3}}")
    walk.run(1.0)
    assert walk.trace[1:] == [(0.35, "x", "y", "on late")]


def test_the_delay_may_be_a_variable_read_when_the_event_is_raised():
    walk = walk_of(
        "{assign: {wait: 0.2}}, {raise: {event: late, after: wait}}, {assign: {wait: 9}}"
    )
    walk.run(1.0)
    assert walk.trace[1:] == [(0.25, "x", "y", "on late")]


def test_events_come_in_the_order_of_their_times_then_of_raising():
    walk = walk_of(
        "{raise: {event: late, after: 0.2}}, {raise: {event: soon, after: 0.1}}, "
        "{raise: {event: soon, after: 0.2}}"
    )
    walk.run(0.2)
    assert walk.memory.variables["n"] == 1
    walk.run(1.0)
    assert (walk.state, walk.memory.variables["n"]) == ("y", 1)


def test_without_delay_an_event_comes_after_those_raised_inside_in_the_same_tick():
    walk = walk_of("{raise: {event: late, after: 0}}, {raise: soon}")
    walk.tick()
    assert (walk.state, walk.memory.variables["n"]) == ("y", 1)


def test_a_cancelled_event_does_not_come():
    walk = walk_of("{raise: {event: late, after: 0.3}}")
    walk.tick()
    walk.tick("stop")
    assert walk.memory.delayed == ()
    walk.run(1.0)
    assert walk.state == "x"


def test_a_failsafe_that_acts_when_an_event_is_due_does_not_swallow_it():
    walk = walk_of("{raise: {event: late, after: 0.1}}")
    walk.run(0.1)
    walk.tick("b")
    assert walk.state == "home"
    walk.tick()
    assert walk.state == "land"


def test_a_delay_that_is_not_valid_is_an_action_that_fails():
    walk = walk_of("{assign: {wait: -1}}, {raise: {event: late, after: wait}}, {log: never}")
    walk.run(1.0)
    assert walk.problems == [
        (
            0.05,
            "raise late after wait: -1.0 is not a valid delay; the event is not raised; "
            "the actions after it are skipped",
        )
    ]
    assert walk.state == "x"


def test_the_number_of_delayed_events_is_bounded():
    walk = walk_of(", ".join(["{raise: {event: late, after: 99}}"] * (MOST_DELAYED + 3)))
    walk.tick()
    assert len(walk.memory.delayed) == MOST_DELAYED
    ((_, problem),) = walk.problems
    assert problem.startswith("raise late: 64 delayed events are under way already")


def test_delayed_events_are_saved_and_come_after_a_resume():
    walk = walk_of("{raise: {event: late, after: 2}}")
    walk.run(1.0)
    saved = value_codec.read(value_codec.written(walk.memory))
    assert saved.delayed == walk.memory.delayed != ()
    for changed in (False, True):
        kept, _, _ = fitted(walk.chart, saved, 1.5, 0.5, changed=changed)
        assert kept.delayed == saved.delayed
