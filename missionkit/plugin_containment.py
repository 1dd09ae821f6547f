"""Calling plug-ins of every group so that none of them can bring the flight down."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TypeVar

T = TypeVar("T")


def is_foreign(plugin: object) -> bool:
    """Say whether a plug-in, an object or its class, comes from outside the package."""
    made_by = plugin if isinstance(plugin, type) else type(plugin)
    return not made_by.__module__.startswith("missionkit.")


class Interrupted(KeyboardInterrupt):
    """A signal ends the program; a plain `KeyboardInterrupt` may come from a plug-in itself."""


@contextmanager
def marking_interrupts() -> Iterator[None]:
    """While this is open, Ctrl-C raises `Interrupted`, which no containment holds back.

    Outside the main thread, where no signal arrives, nothing changes.
    """
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield
        return

    def marked(number: int, frame: FrameType | None) -> None:
        try:
            before(number, frame)
        except KeyboardInterrupt:
            raise Interrupted from None

    signal.signal(signal.SIGINT, marked)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


class PluginError(Exception):
    """A plug-in raised something before the flight; its cause is what it raised."""


@contextmanager
def reporting_faults(*expected: type[BaseException]) -> Iterator[None]:
    """Turn whatever a plug-in raises here into a `PluginError`; a real Ctrl-C stays one.

    Args:
        expected: passes unchanged.

    Raises:
        PluginError: what it raised, in words.
    """
    try:
        with marking_interrupts():
            yield
    except BaseException as error:
        if isinstance(error, (Interrupted, *expected)):
            raise
        raise PluginError(described(error)) from error


def described(error: BaseException) -> str:
    """Return an exception's type and message.

    >>> described(KeyError("x")), described(KeyboardInterrupt())
    ("KeyError: 'x'", 'KeyboardInterrupt')
    """
    said = str(error)
    return f"{type(error).__name__}: {said}" if said else type(error).__name__


class TooSlowError(Exception):
    """A plug-in was interrupted because it did not return."""


class Containment:
    """Calls plug-ins and keeps what went wrong during one tick, a sentence each."""

    def __init__(self) -> None:
        self.failures: list[str] = []

    def call(
        self, name: str, function: Callable[..., T], *arguments: object, foreign: bool = True
    ) -> tuple[T] | None:
        """Return what `function` answers, alone in a tuple, or `None` with a failure noted.

        Args:
            name: for messages.
            function: to call.
            *arguments: of the function.
            foreign: it is a plug-in's; code of missionkit is called directly.
        """
        try:
            if not foreign:
                return (function(*arguments),)
            self.enter(name)
            answer = function(*arguments)
            in_time = self.leave(name)
        except Interrupted:
            raise
        except BaseException as error:  # noqa: BLE001 - a plug-in may do anything
            self.abandon()
            self.note(f"{name} raised {described(error)}")
            return None
        return (answer,) if in_time else None

    def note(self, failure: str) -> None:
        """Record an answer that cannot be used."""
        self.failures.append(failure)

    def take(self) -> tuple[str, ...]:
        """Return the failures so far and forget them."""
        failures = tuple(self.failures)
        self.failures.clear()
        return failures

    def enter(self, name: str) -> None:
        """Start timing a call into the foreign plug-in `name`."""

    def abandon(self) -> None:
        """Stop timing a call that failed."""

    def leave(self, name: str) -> bool:  # noqa: ARG002
        """Stop timing; return whether the answer came in time."""
        return True
