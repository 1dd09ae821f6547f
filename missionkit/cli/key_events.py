"""Events from the person at the keys, while a mission flies."""

from __future__ import annotations

import os
import select
import termios
import tty
from collections.abc import Callable, Mapping
from contextlib import suppress
from types import TracebackType
from typing import Any, Self, TextIO

from missionkit.chart.model.mission import Mission
from missionkit.engine.flight_loop import Operator
from missionkit.messages import Observation, Record, is_event
from missionkit.page.live.offered_actions import CHART_EVENTS, raised_events


def offered(mission: Mission) -> dict[str, str]:
    """Return the events a mission waits for and never raises itself, by key: 1 to 9."""
    raised = raised_events(mission)
    waited: dict[str, None] = {}
    for _, state, _ in mission.walk():
        for transition in state.transitions:
            waited |= dict.fromkeys(map(str, transition.event or ()))
    events = [word for word in waited if is_event(word) and word not in raised]
    own = [word for word in events if not word.startswith(CHART_EVENTS)]
    return {str(key): event for key, event in zip(range(1, 10), own, strict=False)}


class Keys:
    """Sends the event of each key that is pressed on a terminal; elsewhere it does nothing.

    Args:
        stream: where keys come from.
        operator: takes the events.
        events: by key.
        deeds: what other keys do.
    """

    def __init__(
        self,
        stream: TextIO,
        operator: Operator,
        events: dict[str, str],
        deeds: Mapping[str, Callable[[], None]] | None = None,
    ) -> None:
        self._stream = stream
        self._operator = operator
        self._events = events
        self._deeds = deeds or {}
        self._before: Any = None

    def __enter__(self) -> Self:
        if (self._events or self._deeds) and self._stream.isatty():
            self._before = termios.tcgetattr(self._stream)
            tty.setcbreak(self._stream)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._before is not None:
            with suppress(termios.error):  # the terminal has gone
                termios.tcsetattr(self._stream, termios.TCSADRAIN, self._before)

    def __call__(self, _record: Record, _observation: Observation) -> None:
        """Look at the keys, once a tick."""
        if self._before is None:
            return
        while select.select([self._stream], [], [], 0.0)[0]:
            key = self._key()
            if not key:  # the terminal has gone
                self._before = None
                return
            if key in self._events:
                self._operator.send(self._events[key])
            elif key in self._deeds:
                self._deeds[key]()

    def _key(self) -> str:
        try:
            return os.read(self._stream.fileno(), 1).decode(errors="replace")
        except OSError:
            return ""
