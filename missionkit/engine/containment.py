"""Interrupting plug-ins that do not return.

The tick itself contains what plug-ins raise or answer (`missionkit.chart.semantics.contain`).
This module adds the clock that the pure tick may not have.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from typing_extensions import override

from missionkit.chart.semantics.contain import Containment, TooSlowError

GRACE = 1.0  # s between two interruptions of a plug-in that swallows the first


class TimedContainment(Containment):
    """Reports plug-ins that take longer than `limit` (s), and interrupts them where it can.

    The interruption uses an interval timer, which works in the main thread on Unix. Built-in
    plug-ins are not timed: a busy machine must not change how a mission is rehearsed.
    """

    def __init__(self, stopwatch: Callable[[], float], limit: float = 0.25) -> None:
        super().__init__()
        self.stopwatch = stopwatch
        self.limit = limit
        self._started: float | None = None
        self._due = 0.0  # when the plug-in under way is interrupted

    @override
    def enter(self) -> None:
        """Start timing a call into a foreign plug-in."""
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
            self.note(f"{name} took {took:.2f} s, allowed {self.limit:g} s")
            return False
        return True

    @contextmanager
    def interrupting(self) -> Iterator[None]:
        """Interrupt foreign plug-ins that exceed the limit while this context is open."""
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = signal.signal(signal.SIGALRM, self._on_alarm)
        signal.setitimer(signal.ITIMER_REAL, self.limit, self.limit / 2)
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, before)

    def _on_alarm(self, *_: object) -> None:
        if self._started is not None and self.stopwatch() > self._due:
            # what it raises has to be caught before it raises again
            self._due = self.stopwatch() + GRACE
            raise TooSlowError(f"did not return within {self.limit:g} s")
