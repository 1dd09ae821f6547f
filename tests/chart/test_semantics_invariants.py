"""I(s): checked at every tick; a violation is reported once and takes the declared exit."""

from __future__ import annotations

import pytest
from stepping import Walk

from missionkit.geometry import vec
from missionkit.messages import Goal, Target

GPS = """\
initial: out
targets: {t: {position: [50, 0, -5]}}
states:
  out: {kind: gps, behavior: {use: go_to, target: t}}
  return: {kind: return, behavior: {use: go_to, target: home}}
  land: {kind: land}
"""
KNOWN = {"t": Target("t", vec(50, 0, -5), 1.0, None, None, None)}


def test_a_violation_is_reported_once_and_leads_away_when_it_lasts():
    walk = Walk(GPS, targets=KNOWN)
    walk.run(0.5)
    walk.run(2.0, targets={})
    assert walk.problems == [(0.55, "state 'out': the position of t is unknown")]
    assert walk.trace == [(1.55, "out", "hover", "invariant broken for 1 s")]


def test_the_way_out_is_explained_by_the_verdict():
    walk = Walk(GPS, targets={})
    decisions = [walk.tick() for _ in range(21)]
    assert walk.state == "hover"
    ((name, verdict),) = decisions[-1].fired[0].verdicts
    assert (name, verdict.holds, verdict.why) == ("I(out)", False, "the position of t is unknown")


def test_a_short_violation_is_tolerated_and_reported_again_next_time():
    walk = Walk(GPS, targets=KNOWN)
    walk.run(0.9, targets={})
    walk.tick()
    walk.run(1.8, targets={})
    assert walk.trace == []
    assert [at for at, _ in walk.problems] == [0.05, 1.0]


def test_a_violation_counts_again_from_the_next_entry():
    again = "target: t}, transitions: [{to: out, event: again}]}"
    walk = Walk(GPS.replace("target: t}}", again) + "dwell: 0\n", targets={})
    walk.run(0.9)
    walk.tick("again")
    walk.run(1.95)
    assert walk.went() == [(0.95, "out")]
    walk.run(2.0)
    assert walk.went() == [(0.95, "out"), (2.0, "hover")]
    assert [at for at, _ in walk.problems] == [0.05, 1.0]


def test_the_way_out_does_not_wait_for_the_dwell_and_goes_before_transitions():
    text = GPS.replace("target: t}}", "target: t}, transitions: [{to: land, when: a}]}")
    walk = Walk(text + "dwell: 0\n", targets={})
    walk.run(1.0)
    walk.tick("a")
    assert walk.went() == [(1.05, "hover")]


OWN = """\
initial: x
states:
  x: {kind: custom, invariant: {holds: a%s}}
  y: {kind: custom}
  land: {kind: land}
"""


@pytest.mark.parametrize(("way_out", "went"), [("", []), (", exit: y", [(0.3, "y")])])
def test_a_violated_mission_invariant_is_reported_and_takes_its_exit_at_once(way_out, went):
    walk = Walk(OWN % way_out)
    walk.run(0.25, "a")
    walk.run(0.5, "b")
    assert walk.problems == [(0.3, "state 'x': its invariant does not hold")]
    assert walk.went() == went


def test_an_unknown_invariant_is_not_broken():
    walk = Walk(OWN % ", exit: y")
    walk.run(1.0, "a?")
    assert (walk.problems, walk.trace) == ([], [])


def test_every_tick_reports_the_invariant():
    walk = Walk(GPS, targets=KNOWN)
    assert walk.tick().answers["I(out)"].holds is True
    assert walk.tick(targets={}).answers["I(out)"].holds is False


def test_a_task_without_a_goal_yet_is_not_off_its_goal():
    walk = Walk(
        "initial: x\ntargets: {t: {position: [1, 2, 3]}}\nstates:\n"
        "  x: {kind: task, behavior: {use: inject, target: t}}\n"
        "  v: {kind: visual, behavior: {use: servo, target: t}}\n"
        "  land: {kind: land}\n"
    )
    assert walk.tick(goal=None).answers["I(x)"].holds is None
    walk.run(3.0, goal=None)
    assert (walk.problems, walk.trace) == ([], [])
    goal = Goal(vec(0.0, 0.2, -5.0), 0.0, 3.0)
    walk.run(6.0, goal=goal)
    assert walk.trace == [(5.05, "x", "v", "invariant broken for 2 s")]
    assert walk.problems[:1] == [(3.05, "state 'x': 0.20 m from its goal, more than 0.1 m")]
