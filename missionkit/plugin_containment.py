"""Calling plug-ins of every group so that none of them can bring the flight down."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")


def is_foreign(plugin: object) -> bool:
    """Say whether a plug-in comes from outside the package."""
    return not type(plugin).__module__.startswith("missionkit.")


class TooSlowError(Exception):
    """A plug-in was interrupted because it did not return."""


class Containment:
    """Calls plug-ins and keeps what went wrong during one tick, a sentence each."""

    def __init__(self) -> None:
        self.failures: list[str] = []

    def call(
        self, name: str, function: Callable[..., T], *arguments: object, foreign: bool = True
    ) -> tuple[T] | None:
        """Return what `function` answers, alone in a tuple, or `None` with a failure noted."""
        try:
            if not foreign:
                return (function(*arguments),)
            self.enter(name)
            answer = function(*arguments)
            in_time = self.leave(name)
        except (Exception, SystemExit) as error:  # noqa: BLE001 - a plug-in may do anything
            self.abandon()
            self.note(f"{name} raised {type(error).__name__}: {error}")
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
