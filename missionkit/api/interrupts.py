"""Signals that end a program land the vehicle first."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from missionkit.engine.clock import stopwatch
from missionkit.engine.flight_loop import Operator
from missionkit.plugin_containment import Interrupted

STOPPING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)  # Ctrl-C, a service's end, a lost shell
SAME_KEYPRESS = 0.5  # s


@contextmanager
def landing_on_interrupt(operator: Operator) -> Iterator[None]:
    """Let the first of STOPPING land the vehicle, and a second one stop the program.

    Service managers and shells send several at once: what comes within SAME_KEYPRESS counts as one.
    A signal that was ignored before, as `nohup` does, stays ignored. Outside the main thread, where
    Python handles no signals, nothing changes.

    Args:
        operator: gets the request to land.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    first: list[float] = []

    def stop(_: int, __: FrameType | None) -> None:
        if not first:
            first.append(stopwatch())
            operator.land()
        elif stopwatch() - first[0] > SAME_KEYPRESS:
            operator.wants_out = True
            raise Interrupted

    with on_stopping_signals(stop):
        yield


@contextmanager
def on_stopping_signals(handler: Callable[[int, FrameType | None], None]) -> Iterator[None]:
    """Handle the signals that end a program while this is open; one that is ignored stays so."""
    heeded = [it for it in STOPPING if signal.getsignal(it) is not signal.SIG_IGN]
    before = [(it, signal.signal(it, handler)) for it in heeded]
    try:
        yield
    finally:
        for number, previous in before:
            signal.signal(number, previous)
