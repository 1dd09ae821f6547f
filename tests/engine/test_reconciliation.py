"""Where a saved chart and the vehicle disagree, the vehicle is right; every case."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from rehearsed import plain, short, short_stage
from samples import calm

from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.semantics.chart_memory import begin as begin_chart
from missionkit.chart.semantics.step import ABORT
from missionkit.engine.flight_state import FlightMemory, FlightState, PausedBehavior
from missionkit.engine.prepared_mission import PreparedMission, begin, prepare
from missionkit.engine.resume.checkpoint_policy import StartsAgain
from missionkit.engine.resume.reconciliation import (
    CASES,
    ResumeAction,
    ResumedFlight,
    VehicleFacts,
    reconciled,
)
from missionkit.engine.resume.restore_chart import stands
from missionkit.errors import VehicleError
from missionkit.guards.state_progress import GoalUnreachable
from missionkit.messages import Goal, VehicleStatus
from missionkit.rehearsal.rehearse import Kept, rehearse
from missionkit.rehearsal.stage import Stage

HOP = """\
guards: {steady: {use: battery_below, floor: 0.5}}
variables: {laps: 0}
failsafes:
  - {name: battery, when: {use: battery_below, floor: 0.2}, for: 1.0, to: land}
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 4}, transitions: [{to: up, when: done}]}
  wait: {kind: idle, transitions: [{to: up, when: steady}]}
  up:
    kind: custom
    transitions:
      - {to: land, when: steady, for: 3}
      - {to: land, after: 2}
  land: {kind: land}
"""
SAVED_AT, NOW = 10.0, 11.0


@pytest.fixture(scope="module")
def ready() -> Stage:
    return short_stage(HOP)


@pytest.fixture(scope="module")
def plan(ready: Stage) -> PreparedMission:
    return ready.plan


@pytest.fixture(scope="module")
def climbing(ready: Stage) -> FlightMemory:
    """A memory of a real flight, 3 m up."""
    kept: list[Kept] = []
    rehearse(ready, save=kept.append)
    return next(k.course.memory for k in kept if k.course.memory.chart.state == "up")


def standing(memory: FlightMemory, state: str, **acting: Any) -> FlightMemory:
    chart = memory.chart._replace(
        active=(state,), entered={state: 8.0}, pilot="" if state == "wait" else state, started=True
    )
    return memory._replace(now=SAVED_AT, chart=chart, acting=memory.acting._replace(**acting))


def woken(
    plan: PreparedMission, memory: FlightMemory, status: VehicleStatus | None, **more: Any
) -> ResumedFlight:
    changed = more.pop("changed", False)
    saved = FlightState(memory, **more)
    senses = memory.senses
    if status is not None:
        senses = senses._replace(status=status)
    return reconciled(plan, saved, memory._replace(now=NOW, senses=senses), changed=changed)


def heard(*, in_air: bool, armed: bool = True, mode: str = "hold") -> VehicleStatus:
    return VehicleStatus(10.8, armed, in_air, True, mode)


AIR, STANDING, DOWN = heard(in_air=True), heard(in_air=False), heard(in_air=False, armed=False)
FLOWN = {"flown": True}


@pytest.mark.parametrize(
    ("state", "status", "course", "then", "says"),
    [
        ("up", AIR, FLOWN, ResumeAction.GO_ON, "in the air, in up"),
        ("up", heard(in_air=True, mode="offboard"), FLOWN, ResumeAction.GO_ON, "in the air, in up"),
        (
            "up",
            heard(in_air=True, mode="land"),
            FLOWN,
            ResumeAction.LAND,
            "the autopilot is landing",
        ),
        ("land", heard(in_air=True, mode="land"), FLOWN, ResumeAction.GO_ON, "in the air, landing"),
        ("land", AIR, FLOWN, ResumeAction.GO_ON, "in the air, landing"),
        (
            "idle",
            heard(in_air=True, mode="take_off"),
            {},
            ResumeAction.GO_ON,
            "in the air, taking off",
        ),
        (
            "wait",
            AIR,
            {},
            ResumeAction.LAND,
            "in the air, although the chart was on the ground in wait",
        ),
        ("up", DOWN, FLOWN, ResumeAction.LAND, "on the ground, disarmed: the flight is over"),
        ("up", DOWN, {}, ResumeAction.LAND, "on the ground, disarmed: the flight is over"),
        ("land", DOWN, FLOWN, ResumeAction.LAND, "on the ground, disarmed: the flight is over"),
        ("idle", DOWN, FLOWN, ResumeAction.LAND, "on the ground, disarmed: the flight is over"),
        (
            "up",
            STANDING,
            FLOWN,
            ResumeAction.LAND,
            "on the ground, although the chart was flying in up",
        ),
        ("land", STANDING, FLOWN, ResumeAction.GO_ON, "on the ground, landing"),
        ("idle", STANDING, {}, ResumeAction.GO_ON, "on the ground, armed, in idle"),
        ("idle", None, {}, ResumeAction.LAND, "the vehicle is silent"),
        ("up", None, FLOWN, ResumeAction.LAND, "the vehicle is silent"),
    ],
)
def test_every_case(plan, climbing, state, status, course, then, says):
    done = woken(plan, standing(climbing, state), status, **course)
    assert done.notes[0] == f"resumed after 1.00 s: {says}; {then.value}"
    assert done.events == ((ABORT,) if then is ResumeAction.LAND else ())


def test_what_never_was_armed_may_take_off(plan):
    done = woken(plan, standing(begin(plan), "idle"), DOWN)
    assert (done.events, done.notes) == (
        (),
        ("resumed after 1.00 s: on the ground, before take-off; the chart continues",),
    )


def test_what_was_armed_and_is_not_any_more_is_not_armed_again(plan, climbing):
    assert climbing.senses.home is not None
    assert woken(plan, standing(climbing, "idle"), DOWN).events == (ABORT,)


def test_a_take_off_continues_only_with_a_sound_estimate(plan):
    done = woken(plan, standing(begin(plan), "idle"), AIR)
    assert done.events == (ABORT,)
    assert "although the chart was on the ground in idle" in done.notes[0]


@pytest.mark.parametrize(
    ("mode", "failsafe", "says"),
    [
        ("return", True, "the autopilot's own failsafe is in control"),
        ("position", True, "the autopilot's own failsafe is in control"),
        ("return", False, "a pilot or the autopilot's own failsafe is in control"),
        ("position", False, "a pilot is in control"),
    ],
)
def test_a_failsafe_of_the_autopilots_is_not_called_a_pilot(plan, climbing, mode, failsafe, says):
    status = heard(in_air=True, mode=mode)._replace(failsafe=failsafe)
    with pytest.raises(VehicleError) as left:
        woken(plan, standing(climbing, "up"), status)
    assert str(left.value) == f"resumed after 1.00 s: {says}, mode {mode}; nothing is commanded"


def test_a_gap_does_not_count_as_lack_of_progress():
    guard = GoalUnreachable(longer_than=20.0)
    goal = Goal(np.array([50.0, 0.0, -5.0]), 0.0, 0.0)
    memory = guard.advance(None, calm(now=10.0, goal=goal))
    memory = guard.advance(memory, calm(now=25.0, goal=goal))
    later = calm(now=85.0, goal=goal)
    assert guard.check(memory, later).holds
    resumed = guard.resumed(memory, 55.0)
    assert not guard.check(resumed, later).holds
    assert guard.check(resumed, calm(now=86.0, goal=goal)).holds
    assert guard.resumed(None, 55.0) is None


@pytest.mark.parametrize("mode", ["position", "manual", "stabilized", ""])
@pytest.mark.parametrize("state", ["idle", "up", "land"])
def test_a_pilot_in_control_is_not_disturbed(plan, climbing, mode, state):
    with pytest.raises(
        VehicleError, match=f"a pilot is in control, mode {mode}; nothing is commanded"
    ):
        woken(plan, standing(climbing, state), heard(in_air=True, mode=mode))


def test_without_a_state_that_lands_nothing_is_commanded(climbing):
    """The pilot's landing would lead nowhere."""
    plan = other(HOP.replace("kind: land", "kind: hover"))
    with pytest.raises(VehicleError, match="nothing is commanded"):
        woken(plan, standing(climbing, "up"), DOWN, flown=True)


def test_the_cases_cover_every_combination():
    answers = (True, False)
    modes = ("hold", "offboard", "take_off", "land", "manual")
    for air, armed, flying, landing, climb, flown, placed, mode in (
        (a, b, c, d, e, f, g, m)
        for a in answers
        for b in answers
        for c in answers
        for d in answers
        for e in answers
        for f in answers
        for g in answers
        for m in modes
    ):
        status = VehicleStatus(1.0, armed, air, True, mode)
        facts = VehicleFacts(status, "x", flying, landing, climb, flown, placed, lost=False)
        case = next(case for case in CASES if case.applies(facts, status))
        if not air and not armed and (flown or flying):
            assert case.then is ResumeAction.LAND  # never armed again
        if air and case.then is ResumeAction.GO_ON:
            assert mode != "manual"
            assert flying or landing or climb


def test_a_flight_continues_only_with_a_sound_estimate(plan, climbing):
    """So long after the last inertial sample nothing is known."""
    memory = standing(climbing, "up")
    navigation = memory.senses.navigation._replace(now=NOW + 40.0)
    lost = memory._replace(senses=memory.senses._replace(navigation=navigation))
    done = woken(plan, lost, AIR, **FLOWN)
    assert done.events == (ABORT,)
    assert "in the air, in up, and the estimate has diverged; landing" in done.notes[0]


def test_an_old_heartbeat_does_not_count(plan, climbing):
    old = AIR._replace(at=SAVED_AT)
    assert "the vehicle is silent" in woken(plan, standing(climbing, "up"), old).notes[0]


def test_timers_continue_but_guards_must_hold_again(plan, climbing):
    memory = standing(climbing, "up")
    numbers = [way.number for way in plan.chart.states["up"].transitions]
    failsafe = plan.chart.failsafes[0].number
    held = {numbers[0]: 9.0, failsafe: 9.5}
    memory = memory._replace(chart=memory.chart._replace(held=held, violated={"up": 9.0}))
    chart = woken(plan, memory, AIR, flown=True).course.memory.chart
    assert chart.held == {failsafe: 9.5}
    assert (chart.entered, chart.violated) == ({"up": 8.0}, {"up": 9.0})


def test_control_starts_from_the_velocity_that_was_measured(plan, climbing):
    nav = climbing.senses.navigation
    control = woken(plan, standing(climbing, "up"), AIR).course.memory.acting.control
    measured = plan.navigator.read(nav).velocity
    assert norm_of(measured) > 1e-3
    assert control == plan.law.begin()._replace(velocity=tuple(measured.tolist()))


def norm_of(v: Any) -> float:
    return float(np.linalg.norm(v))


def test_home_is_where_it_stood_if_it_took_off_unnoticed(plan, climbing):
    memory = standing(climbing, "idle")
    memory = memory._replace(senses=memory.senses._replace(home=None))
    done = woken(plan, memory, AIR).course.memory.senses
    np.testing.assert_array_equal(done.home, plan.navigator.read(memory.senses.navigation).position)


def test_an_unsaved_memory_restarts(plan, climbing):
    memory = standing(climbing, "up")
    lost = (StartsAgain.BEGIN,) * len(memory.chart.windows)
    memory = memory._replace(chart=memory.chart._replace(windows=lost))
    chart = woken(plan, memory, AIR).course.memory.chart
    assert chart.windows == begin_chart(plan.chart, 0.0).windows


def other(text: str) -> PreparedMission:
    return prepare(short(text), builtin())


def test_a_changed_mission_keeps_the_place_and_the_variables_only(climbing):
    plan = other(HOP.replace("after: 2", "after: 20"))
    memory = standing(climbing, "up", paused={"up": PausedBehavior(1, done=True, goal=None)})
    chart = memory.chart._replace(held={0: 1.0}, variables={"laps": 3, "gone": 1})
    done = woken(plan, memory._replace(chart=chart), AIR, flown=True, changed=True)
    after = done.course.memory
    assert (after.chart.state, after.chart.entered) == ("up", {"up": 8.0})
    assert after.chart.variables == {"laps": 3}
    assert (after.chart.held, after.acting.begun, after.acting.paused) == ({}, False, {})
    assert done.events == ()
    assert done.notes[1:] == ("guards, behaviours and histories restart",)


def test_a_state_removed_from_the_chart_lands(climbing):
    plan = other(HOP.replace("up", "aloft"))
    done = woken(plan, standing(climbing, "up"), AIR, flown=True, changed=True)
    assert done.events == (ABORT,)
    assert "in a state that the chart no longer has; landing" in done.notes[0]
    assert done.notes[1] == "the chart no longer has up: it restarts"
    assert done.course.memory.chart.state == "idle"


BOXES = """\
initial: box
states:
  box:
    kind: custom
    parallel: true
    states:
      left:
        kind: custom
        initial: a
        states:
          a: {kind: custom, transitions: [{to: b, after: 1}]}
          b: {kind: custom, transitions: [{to: land, after: 1}]}
          was: {history: deep, default: a}
      right: {kind: logic}
  land: {kind: land, transitions: [{to: was, after: 900}]}
"""


@pytest.mark.parametrize(
    ("active", "legal"),
    [
        (("box", "left", "a", "right"), True),
        (("box", "left", "b", "right"), True),
        (("land",), True),
        (("box", "left", "right"), False),
        (("box", "left", "a"), False),
        (("left", "a", "right"), False),
        (("box", "left", "a", "b", "right"), False),
        (("box", "left", "was", "right"), False),
        (("box", "right", "left", "a"), False),
        (("box", "left", "a", "right", "land"), False),
        (("land", "land"), False),
        (("elsewhere",), False),
        ((), False),
    ],
)
def test_only_a_whole_configuration_is_a_place(active, legal):
    chart = other(BOXES).chart
    assert stands(chart, begin_chart(chart, 0.0)._replace(active=active, entered={})) is legal


def test_reconciling_changes_nothing_in_what_was_saved(plan, climbing):
    memory = standing(climbing, "up")
    before = plain(memory)
    woken(plan, memory, AIR)
    assert plain(memory) == before
