"""What a pause leaves alone: failsafes, events, landing; and what it holds back on the ground."""

from __future__ import annotations

import pytest
from rehearsed import Flight, flown, short_stage

from missionkit.engine import pause
from missionkit.engine.flight_loop import Operator
from missionkit.messages import CONTINUE, PAUSE, Action

CHART = """\
failsafes: [{name: battery, when: {use: battery_below, floor: 0.5}, unknown: ignore, to: down}]
initial: up
states:
  up: {kind: idle, behavior: {use: take_off, height: 3}, transitions: [{to: work, when: done}]}
  work:
    kind: custom
    behavior: {use: climb, height: 40}
    transitions: [{to: away, event: away}, {to: down, after: 8}]
  away: {kind: custom, behavior: {use: climb, height: 1}, transitions: [{to: down, when: done}]}
  down: {kind: land}
"""


class Sending(Operator):
    """Sends events at ticks of the flight."""

    def __init__(self, due: dict[int, str]) -> None:
        super().__init__()
        self.due, self.ticks = due, 0

    def take(self) -> tuple[str, ...]:
        self.ticks += 1
        return (self.due[self.ticks],) if self.ticks in self.due else ()


def fly(due: dict[int, str], *faults: str) -> Flight:
    return flown(short_stage(CHART, *faults), Sending(due))


def test_a_mission_that_is_paused_on_the_ground_is_not_armed():
    flight = fly({1: PAUSE, 300: CONTINUE})
    ordered = [r.now for r in flight.records if r.command.action in {Action.ARM, Action.TAKE_OFF}]
    assert ordered[0] == pytest.approx(15.0)
    assert {r.step_note for r in flight.records[60:298]} == {pause.BY_OPERATOR}
    assert flight.result.grade.landed


def test_a_failsafe_ends_a_pause_and_the_clock_of_the_state_stood_still():
    flight = fly({200: PAUSE}, "battery_sag=0.6@30")
    reasons = [reason for _, reason in flight.went()]
    assert reasons == ["when done", "failsafe battery"]
    assert flight.entered("down") >= 30.0
    assert flight.records[-1].step_note != pause.BY_OPERATOR
    assert flight.result.grade.landed


def test_an_event_changes_the_state_and_the_vehicle_waits_in_the_new_one():
    flight = fly({200: PAUSE, 230: "away", 400: CONTINUE})
    waits = [r for r in flight.records if r.state == "away" and r.now < 19.9]
    assert {r.step_note for r in waits} == {pause.BY_OPERATOR}
    assert min(-r.estimate.position[2] for r in waits[20:]) > 2.0
    assert flight.went()[-1] == ("down", "when done")


@pytest.mark.parametrize(
    ("before", "events", "after"),
    [
        (False, (PAUSE,), True),
        (True, (), True),
        (True, (CONTINUE,), False),
        (True, (CONTINUE, PAUSE), True),
        (False, ("pause",), False),
    ],
)
def test_the_last_word_of_the_operator_counts(before, events, after):
    assert pause.asked(before, events) is after
