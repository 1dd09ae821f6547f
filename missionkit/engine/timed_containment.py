"""Interrupting plug-ins that do not return.

The tick itself contains what plug-ins raise or answer (`plugin_containment`).
This module adds the clock that the pure tick may not have.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from typing_extensions import override

from missionkit.number_text import beside
from missionkit.plugin_containment import Containment, TooSlowError

INTERRUPTION_GAP = 1.0  # s between two interruptions of a plug-in that swallows the first
WAITING = "did not return; a plug-in must neither sleep nor wait"


class TimedContainment(Containment):
    """Reports plug-ins that take longer than `limit` (s), and interrupts them where it can.

    The interruption uses an interval timer, which works in the main thread on Unix. Built-in
    plug-ins are not timed: a busy machine must not change how a mission is rehearsed.

    Args:
        stopwatch: s. Over a vehicle the wall's time. In a rehearsal the thread's processor time,
            so that it does not matter what else the machine does.
        limit: s on the stopwatch, for each call.
        patience: s of the wall after which a call is interrupted although the stopwatch says
            little: it sleeps or waits. From then on that plug-in has `limit` of the wall.
    """

    def __init__(
        self, stopwatch: Callable[[], float], limit: float = 0.25, patience: float = 10.0
    ) -> None:
        super().__init__()
        self.stopwatch = stopwatch
        self.limit = limit
        self._every = limit / 2.0  # s of the wall between two looks
        self._patience = round(patience / self._every)  # looks
        self._started: float | None = None
        self._due = 0.0  # on the stopwatch, when the plug-in under way is interrupted
        self._name = ""
        self._waiting: set[str] = set()  # plug-ins that were seen to sleep or wait
        self._looks = 0  # left until the plug-in under way counts as waiting

    @override
    def enter(self, name: str) -> None:
        """Start timing a call into the foreign plug-in `name`."""
        self._name = name
        self._looks = 2 if name in self._waiting else self._patience
        started = self.stopwatch()
        self._due = started + self.limit
        self._started = started

    @override
    def abandon(self) -> None:
        """Stop timing a call that failed."""
        self._started = None

    @override
    def leave(self, name: str) -> bool:
        """Stop timing; note the plug-in `name` and return False if it took too long."""
        started, self._started = self._started, None
        took = 0.0 if started is None else self.stopwatch() - started
        if took > self.limit:
            shown, limit = beside(took, self.limit, 2)
            self.note(f"{name} took {shown} s, allowed {limit} s")
            return False
        return True

    @contextmanager
    def interrupting(self) -> Iterator[None]:
        """Interrupt foreign plug-ins that exceed the limit while this context is open."""
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = signal.signal(signal.SIGALRM, self._on_alarm)
        signal.setitimer(signal.ITIMER_REAL, self.limit, self._every)
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, before)

    def _on_alarm(self, *_: object) -> None:
        """Look at the plug-in under way.

        Looks are counted instead of the wall's time: a machine that was suspended has not waited.
        What is raised here has to be caught before it is raised again.
        """
        if self._started is None:
            return
        self._looks -= 1
        if self.stopwatch() > self._due:
            self._due = self.stopwatch() + INTERRUPTION_GAP
            raise TooSlowError(f"did not return within {self.limit:g} s")
        if self._looks <= 0:
            self._looks = round(INTERRUPTION_GAP / self._every)
            self._waiting.add(self._name)
            raise TooSlowError(WAITING)
