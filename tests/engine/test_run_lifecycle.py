from __future__ import annotations

import logging

import pytest

from missionkit.engine.flight_loop import Operator, _pressing
from missionkit.engine.run_lifecycle import Lifecycle
from missionkit.messages import ABORT

WAY = {  # the triggers that lead to each state
    "ready": (),
    "flying": ("start",),
    "aborting": ("start", "abort"),
    "ended": ("start", "finish"),
}
TABLE = {  # state -> where each trigger leads; a trigger that is not named is ignored
    "ready": {"start": "flying"},
    "flying": {"abort": "aborting", "finish": "ended"},
    "aborting": {"finish": "ended"},
    "ended": {},
}


def living(state: str) -> Lifecycle:
    life = Lifecycle()
    for trigger in WAY[state]:
        getattr(life, trigger)()
    assert life.state == state
    return life


@pytest.mark.parametrize("trigger", ["start", "abort", "finish"])
@pytest.mark.parametrize("state", TABLE)
def test_every_trigger_in_every_state(state, trigger):
    life = living(state)
    getattr(life, trigger)()
    assert life.state == TABLE[state].get(trigger, state)


@pytest.mark.parametrize("late", [True, False])
def test_an_abort_begins_once_and_is_seen_at_every_tick(late, caplog):
    life, operator = living("flying"), Operator()
    assert _pressing(life, operator, late=False) == ()
    if not late:
        operator.land()
    with caplog.at_level(logging.WARNING):
        assert [_pressing(life, operator, late=late) for _ in range(3)] == [(ABORT,)] * 3
    assert life.state == "aborting"
    assert caplog.records == []
