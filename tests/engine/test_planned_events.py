"""Events of an operator that are planned before the flight."""

from __future__ import annotations

import pytest

from missionkit.engine.flight_loop import Operator
from missionkit.engine.planned_events import PlannedEvents, planned
from missionkit.errors import UsageError
from missionkit.messages import Record


def record_at(now, *active):
    fields = dict.fromkeys(Record._fields)
    return Record(**{**fields, "now": now, "active": active})


def test_events_are_sent_at_their_time_or_after_a_state_was_first_entered():
    operator, sent = Operator(), []
    texts = ["stop.now@2", "go@0.5", "operator.pause@poles/p1:1", "here@poles/p1"]
    plan = PlannedEvents([planned(text) for text in texts], operator)
    for tick in range(1, 80):
        now = 0.05 * tick
        plan(record_at(now, "up" if now < 0.97 or now > 1.42 else "poles/p1"), None)
        sent += [(round(now, 2), event) for event in operator.take()]
    assert sent == [(0.5, "go"), (1.0, "here"), (2.0, "stop.now"), (2.0, "operator.pause")]


@pytest.mark.parametrize("text", ["go", "@3", "go@", "go@-1", "go@inf:x", "a b@1", "go@up:soon"])
def test_an_unreadable_plan_is_reported(text):
    with pytest.raises(UsageError, match="expected NAME@SECONDS or NAME@STATE"):
        planned(text)


def test_an_unknown_state_is_reported_with_the_nearest():
    with pytest.raises(UsageError, match=r"unknown state 'hovr'.*hover"):
        planned("go@hovr", {"hover", "land"})
