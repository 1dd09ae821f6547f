"""Events of an operator that are planned before a flight: at a time, or after a state is entered.

    NAME@WHEN      WHEN: seconds, or STATE[:DELAY]

`go@12.5` at 12.5 s; `operator.pause@survey:10` 10 s after survey was first entered.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Sequence
from typing import NamedTuple

from missionkit.engine.flight_loop import Operator
from missionkit.errors import UsageError, nearest
from missionkit.messages import Observation, Record, is_event

WHEN = re.compile(r"(?P<at>[0-9.eE+-]+)|(?P<state>[A-Za-z][\w/-]*)(:(?P<delay>[0-9.]+))?")


class PlannedEvent(NamedTuple):
    """An event, and when it is sent."""

    event: str
    delay: float  # s, from take-off of the mission's clock or the first entry of the state
    state: str | None = None


def planned(text: str, states: Collection[str] | None = None) -> PlannedEvent:
    """Read an event as an option gives it.

    Args:
        text: NAME@WHEN.
        states: of the mission; None: they are not checked.

    Raises:
        UsageError: it is not of that form, or names a state that the mission does not have.
    """
    event, _, when = text.partition("@")
    match = WHEN.fullmatch(when)
    try:
        delay = math.nan if match is None else float(match["at"] or match["delay"] or 0.0)
    except ValueError:
        delay = math.nan
    if match is None or not is_event(event) or not 0.0 <= delay < math.inf:
        raise UsageError(
            f"event {text!r}: expected NAME@SECONDS or NAME@STATE[:SECONDS], such as go@12.5"
        )
    state = match["state"]
    if state is not None and states is not None and state not in states:
        raise UsageError(f"event {text!r}: unknown state {state!r}; {nearest(state, states)}")
    return PlannedEvent(event, delay, state)


class PlannedEvents:
    """Sends planned events when they are due; an observer of the flight."""

    def __init__(self, events: Sequence[PlannedEvent], operator: Operator) -> None:
        self._left = list(events)
        self._operator = operator
        self._entered: dict[str | None, float] = {None: 0.0}

    def __call__(self, record: Record, _observation: Observation) -> None:
        """Send what is due, to be heard at the next tick."""
        for state in record.active:
            self._entered.setdefault(state, record.now)
        due = [(self._due(it), it) for it in self._left if self._due(it) <= record.now]
        for _, it in sorted(due, key=lambda each: each[0]):
            self._operator.send(it.event)
            self._left.remove(it)

    def _due(self, it: PlannedEvent) -> float:
        return self._entered.get(it.state, math.inf) + it.delay
