"""Success and failure of short flights, graded by their ground truth."""

from __future__ import annotations

from functools import cache

import pytest
from rehearsed import flown, short, short_stage

from missionkit.chart.model.mission_sections import Success
from missionkit.engine.flight_history import FlightHistory, TakenFailsafe, after
from missionkit.engine.mission_success import TruthSummary, conditions, flaws
from missionkit.errors import FileError
from missionkit.messages import Fired, Verdict
from missionkit.outcome import outcome, reason, succeeded
from missionkit.sim.fault_injection import parse_fault

BELOW = """\
targets: {spot: {position: [20, 0, 5]}}
initial: up
states:
  up: {kind: idle, behavior: {use: take_off, height: 5}, transitions: [{to: out, when: done}]}
  out:
    kind: gps
    behavior: {use: go_to, target: spot}
    transitions: [{to: down, when: done}, {to: down, after: 60}]
  down: {kind: land}
"""
ROUND = """\
initial: up
states:
  up: {kind: idle, behavior: {use: take_off, height: 2}, transitions: [{to: work, when: done}]}
  work:
    initial: one
    transitions: [{to: down, when: done}]
    states:
      one: {kind: custom, transitions: [{to: two, after: 1}]}
      two: {kind: custom, transitions: [{to: finished, after: 1}]}
      finished: {final: true}
  down: {kind: land}
"""


@cache
def flight(text, *faults):
    ready = short_stage(text)
    if faults:
        vehicle = type(ready.vehicle)(
            ready.world, ready.mission.camera, 0, tuple(map(parse_fault, faults))
        )
        ready = ready._replace(vehicle=vehicle)
    return flown(ready)


def test_a_target_below_the_ground_fails_and_ends_on_the_ground():
    low = flight(BELOW)
    assert outcome(low.result) == "ended_safely"
    assert reason(low.result).startswith("not a success: touched the ground at ")
    assert low.went()[-1] == ("down", "failsafe ground touched")
    touched = low.result.grade.touched_at
    heard = [r.now for r in low.records if "ground_touched" in r.estimate.events]
    assert len(heard) == 1
    assert heard[0] == pytest.approx(touched, abs=0.4)
    assert low.records[-1].now < touched + 5.0
    assert "touched the ground outside landing and take-off" in low.problems()


def test_landing_and_taking_off_touch_nothing():
    whole = flight(ROUND)
    assert whole.result.succeeded
    assert whole.result.grade.touched_at is None
    assert whole.problems() == []
    assert whole.result.grade.landing_error < 2.0
    assert whole.result.grade.estimate_error < 2.0


def test_several_conditions_are_each_listed_with_their_figure():
    text = ROUND + "success: [{visit: one}, {visit: finished}, {visit: work}, {failsafes: 0}]\n"
    met = flight(text).result
    assert met.succeeded
    assert [(it.says, it.met) for it in met.conditions] == [
        ("one visited", True),
        ("finished visited", True),
        ("work visited", True),
        ("at most 0 failsafes taken", True),
    ]
    assert met.conditions[3].figure == "0"
    assert met.conditions[0].figure.startswith("at ")


def test_entered_is_not_done():
    text = ROUND + "success: [{visit: up}, {done: up}, {done: one}]\n"
    flight_ = flight(text).result
    assert [(it.says, it.met) for it in flight_.conditions] == [
        ("up visited", True),
        ("up finished", True),
        ("one finished", False),
    ]
    assert flight_.conditions[2].figure == "never"
    assert not flight_.succeeded
    assert reason(flight_) == "landed, but conditions were not met: one finished: never"


def test_a_transition_on_done_alone_says_that_a_behaviour_finished():
    chart = short_stage(ROUND).plan.chart
    fired = Fired("up", "work", "when done", (("done", Verdict(holds=True)),), ())
    assert after(FlightHistory(), fired, 7.0, chart).finished == {"up": 7.0}


def test_a_success_past_failsafes_names_them():
    taken = (TakenFailsafe(3.0, "when disturbed", default=True),) * 2
    assert succeeded(FlightHistory()) == "flown as planned"
    assert succeeded(FlightHistory(failsafes=taken)) == (
        "flown as planned, despite these failsafes: when disturbed (2 times)"
    )


def test_one_unmet_condition_of_several_is_not_a_success():
    text = ROUND.replace("{to: two, after: 1}", "{to: finished, after: 1}")
    missed = flight(text + "success: [{visit: one}, {visit: two, clearance: 1.0}]\n").result
    assert not missed.succeeded
    assert [it.met for it in missed.conditions] == [True, False, True]
    assert missed.conditions[1].figure == "never"
    assert reason(missed) == "landed without reaching two"


def test_a_mission_that_says_nothing_of_success_has_none_if_a_failsafe_landed_it():
    failsafe = "failsafes: [{name: low, when: {use: battery_below, floor: 0.5}, to: down}]\n"
    sag = "battery_sag=0.6@6"
    silent = flight(failsafe + ROUND.replace("after: 1}", "after: 9}"), sag).result
    assert silent.grade.landed
    assert outcome(silent) == "ended_safely"
    assert reason(silent).startswith("not a success: failsafe low ended it at ")
    said = failsafe + ROUND.replace("{to: finished, after: 1}", "{to: finished, after: 9}")
    assert flight(said + "success: {visit: one}\n", sag).result.succeeded


@pytest.mark.parametrize(
    ("success", "says"),
    [
        ("{}", "needs at least one of 'visit', 'done', 'docked', 'clearance', 'failsafes', 'rob"),
        ("[{failsafes: 0, target: x}]", "unknown target 'x'"),
        ("{clearance: 1.0, position: 0.3}", "'position' needs 'visit'"),
        ("[{visit: nowhere}]", "unknown state 'nowhere'"),
        ("{failsafes: -1}", "failsafes"),
        ("{robots_home: 0}", "robots_home"),
        ("3", "success"),
    ],
)
def test_impossible_success_conditions_are_reported(success, says):
    with pytest.raises(FileError) as error:
        short(ROUND + f"success: {success}\n")
    assert says in str(error.value)
    assert "short.yaml:" in str(error.value)


GOOD = TruthSummary({}, clearance=0.8)
FLAWED = {
    "touched the ground at 9.0 s": GOOD._replace(touched_at=9.0),
    "left its fence by 2.0 m (ground truth)": GOOD._replace(outside_fence=2.0),
    "the estimate was up to 30.0 m off": GOOD._replace(estimate_error=30.0),
    "landed 36.0 m from where it meant to": GOOD._replace(landing_error=36.0),
}


@pytest.mark.parametrize("says", FLAWED)
def test_what_no_success_survives(says):
    wanted = (Success(clearance=0.5),)
    assert flaws(wanted, FlightHistory(), GOOD) == ()
    (found,) = flaws(wanted, FlightHistory(), FLAWED[says])
    assert found.startswith(says)


def test_landing_without_a_position_is_not_a_success():
    """The work was done; then fixes jumped, and the mission's failsafe landed it somewhere."""
    lost = FlightHistory(lost="GNSS jumped 20 m")
    (found,) = flaws((Success(clearance=0.5),), lost, GOOD)
    assert found == "did not know its position when it began to land: GNSS jumped 20 m"


def test_passing_too_close_is_not_a_success():
    for wanted, met in ((0.5, True), (0.81, False)):
        (found,) = conditions((Success(clearance=wanted),), FlightHistory(), GOOD)
        assert (found.met, found.figure) == (met, "0.80 m")
    (just,) = conditions(
        (Success(clearance=0.5),), FlightHistory(), GOOD._replace(clearance=0.4996)
    )
    assert (just.met, just.figure) == (False, "0.4996 m")
    assert conditions((Success(clearance=0.5),), FlightHistory(), None)[0].met is None


LOST = """\
targets: {t: {position: [9, 0, -3]}}
perception: [{use: aruco, target: t, id: 1, size: 0.4}]
failsafes: [{name: link, when: link_lost, to: land}]
initial: fly
states:
  fly: {kind: gps, behavior: {use: go_to, target: t}, transitions: [{to: see, after: 9}]}
  see: {kind: visual, behavior: {use: servo, target: t}, transitions: [{to: home, after: 9}]}
  look: {kind: search, behavior: {use: spiral, target: t}, transitions: [{to: see, after: 9}]}
  home: {kind: return, behavior: {use: go_to, target: home}, transitions: [{to: land, when: done}]}
  land: {kind: land}
"""
FAR = "unreachable, when goal unreachable"
LOCK = "lock-lost, when target lost (target t, longer_than 2)"


@pytest.mark.parametrize(
    ("way", "ended_by", "taken"),
    [
        ([("fly", "hover", FAR), ("hover", "home", "after 20 s")], FAR, 1),
        ([("fly", "hover", FAR), ("hover", "fly", "when x"), ("see", "home", "after 9 s")], "", 1),
        (
            [("see", "look", LOCK), ("look", "see", "after 9 s"), ("see", "home", "after 9 s")],
            "",
            1,
        ),
        ([("see", "land", "failsafe link")], "failsafe link", 1),
        ([("fly", "hover", "invariant broken for 1 s")], "invariant broken for 1 s", 1),
        ([("fly", "see", "after 9 s"), ("see", "home", "after 9 s")], "", 0),
    ],
)
def test_a_failsafe_ends_a_flight_unless_the_plan_is_taken_up_again(way, ended_by, taken):
    chart = short_stage(LOST).plan.chart
    passage = FlightHistory()
    for n, (source, to, why) in enumerate(way):
        passage = after(passage, Fired(source, to, why, (), ()), float(n), chart)
    assert ("" if passage.ended_by is None else passage.ended_by.label) == ended_by
    assert len(passage.failsafes) == taken
    default = FlightHistory(
        ended_by=TakenFailsafe(1.0, "unreachable, when goal unreachable", default=True)
    )
    assert flaws((Success(clearance=1.0),), default, None) == (
        "a default failsafe ended it at 1.0 s: unreachable, when goal unreachable",
    )


@pytest.mark.parametrize(
    ("truth", "met", "figure"),
    [
        (None, None, "known only in simulation"),
        (TruthSummary({}, 1.0, robots_home=None), False, "no robots in the world"),
        (TruthSummary({}, 1.0, robots_home=6), False, "6"),
        (TruthSummary({}, 1.0, robots_home=7), True, "7"),
    ],
)
def test_enough_robots_must_be_home(truth, met, figure):
    (found,) = conditions((Success(robots_home=7),), FlightHistory(), truth)
    assert (found.says, found.met, found.figure) == ("at least 7 robots home", met, figure)
