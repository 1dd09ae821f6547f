"""Failsafes: before everything else, in the air only, and never to something less safe."""

from __future__ import annotations

import pytest
from samples import calm
from stepping import Walk, chart_of

from missionkit.chart.semantics.step import ABORT
from missionkit.messages import VehicleStatus

STATES = """\
states:
  idle: {kind: idle, transitions: [{to: x, event: up}]}
  x: {kind: custom, transitions: [{to: y, when: c}]}
  y: {kind: custom, transitions: [{to: x, when: c}, {to: return, event: home}]}
  return: {kind: return, behavior: {use: go_to, target: home}}
  land: {kind: land, transitions: [{to: idle, event: again}]}
"""
FAILSAFES = """\
failsafes:
  - {name: home, when: a, unknown: ignore, to: return}
  - {name: down, when: b, unknown: ignore, to: land}
"""


def walk_of(initial: str, failsafes: str = FAILSAFES, dwell: float = 2.0, **always) -> Walk:
    return Walk(f"initial: {initial}\ndwell: {dwell}\n" + failsafes + STATES, **always)


def test_a_failsafe_ignores_the_dwell():
    walk = walk_of("x")
    walk.tick("a")
    assert walk.trace == [(0.05, "x", "return", "failsafe home")]


def test_landing_is_never_left_for_the_way_home_nor_the_way_home_for_itself():
    walk = walk_of("x")
    walk.run(0.2, "a")
    walk.run(0.4, "a", "b")
    walk.run(1.0, "a")
    walk.tick("a", "b", ABORT)
    assert walk.went() == [(0.05, "return"), (0.25, "land")]


@pytest.mark.parametrize(
    ("unknown", "expected"), [("take", [(0.05, "land")]), ("ignore", [])], ids=["take", "ignore"]
)
def test_every_failsafe_says_what_unknown_means(unknown, expected):
    walk = walk_of("x", f"failsafes: [{{name: f, when: a, unknown: {unknown}, to: land}}]\n")
    walk.run(0.5, "a?")
    assert walk.went() == expected


def test_what_is_unknown_counts_towards_the_time_of_a_failsafe_that_takes_it():
    walk = walk_of("x", "failsafes: [{name: f, when: a, unknown: take, for: 0.2, to: land}]\n")
    walk.tick("a")
    walk.run(0.2, "a?")
    walk.tick("a")
    assert walk.went() == [(0.25, "land")]


def test_on_the_ground_no_failsafe_applies():
    down = VehicleStatus(0.0, armed=False, in_air=False, ready=True, mode="hold")
    walk = walk_of("x", status=down)
    walk.run(0.5, "a", "b")
    assert walk.trace == []
    walk.tick("a", status=down._replace(armed=True))
    assert walk.went() == [(0.55, "return")]


def test_a_vehicle_that_never_spoke_is_taken_to_be_in_the_air():
    walk = walk_of("x", status=None)
    walk.tick("a")
    assert walk.state == "return"


def test_idle_is_left_in_the_air_but_not_on_the_ground():
    armed = VehicleStatus(0.0, armed=True, in_air=False, ready=True, mode="take_off")
    walk = walk_of("idle", status=armed)
    walk.run(1.0, "a", "b")
    assert walk.trace == []
    walk.tick("a", status=armed._replace(in_air=True))
    assert walk.state == "return"


def test_the_time_of_a_failsafe_runs_on_while_states_change():
    timed = "failsafes: [{name: f, when: a, unknown: ignore, for: 1.0, to: land}]\n"
    walk = walk_of("x", timed, dwell=0.3)
    walk.run(0.2)
    walk.run(3.0, "a", "c")
    assert walk.went() == [(0.3, "y"), (0.6, "x"), (0.9, "y"), (1.2, "x"), (1.25, "land")]


def test_plugins_that_keep_failing_lead_home_and_then_down():
    walk = walk_of("x", "")
    walk.run(0.5)
    walk.run(8.0, failing=("gust raised ValueError",))
    assert walk.trace == [
        (3.55, "x", "return", "failsafe plug-in failed"),
        (6.55, "return", "land", "failsafe plug-in failed"),
    ]


def test_plugins_that_recover_in_time_change_nothing():
    walk = walk_of("x", "")
    for _ in range(4):
        walk.run(walk.seen().now + 2.9, failing=("gust raised ValueError",))
        walk.tick()
    assert walk.trace == []


def test_two_failsafes_do_not_throw_the_vehicle_to_and_fro():
    both = """\
failsafes:
  - {name: one, when: a, unknown: ignore, to: x}
  - {name: two, when: b, unknown: ignore, to: y}
  - {name: three, when: c, unknown: ignore, to: land}
"""
    walk = walk_of("y", both, dwell=9)
    walk.run(1.0, "a", "b")
    assert walk.trace == [(0.05, "y", "x", "failsafe one")]
    walk.tick("b")
    assert walk.went()[1:] == [(1.05, "y")]
    walk.tick("a", "b", "c")
    walk.tick("a", "b", "c")
    assert walk.went()[2:] == [(1.1, "x"), (1.15, "land")]


@pytest.mark.parametrize("start", ["idle", "x", "y", "return", "land"])
def test_the_pilot_lands_from_everywhere(start):
    walk = walk_of(start)
    walk.tick("a", ABORT)
    assert walk.state == "land"
    walk.run(1.0, ABORT)
    assert [reason for *_, reason in walk.trace] == ["operator: land"] * (start != "land")


def test_the_verdict_that_decided_is_in_the_record():
    text = "initial: x\nfailsafes: [{name: f, when: {use: battery_below, floor: 0.95}, to: land}]\n"
    fired = Walk(chart_of(text + STATES)).tick().fired
    ((name, verdict),) = fired[0].verdicts
    assert name == "battery below (floor 0.95)"
    assert (verdict.holds, verdict.value, verdict.threshold) == (True, calm().battery.charge, 0.95)
