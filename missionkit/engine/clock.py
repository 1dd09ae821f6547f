"""How fast mission time passes. The only place that reads a clock or sleeps."""

from __future__ import annotations

import asyncio
import time
from typing import Protocol


class Pace(Protocol):
    """Lets mission time pass."""

    async def until(self, at: float) -> None:
        """Return when mission time `at` (s) has come."""


class Unhurried:
    """Waits for nothing: a simulation as fast as the machine allows."""

    async def until(self, at: float) -> None:
        """Return at once."""


class RealTime:
    """Ties mission time to the wall, `speed` times as fast, beginning at `since` (s)."""

    def __init__(self, speed: float = 1.0, since: float = 0.0) -> None:
        self._speed = speed
        self._start = time.perf_counter() - since / speed

    async def until(self, at: float) -> None:
        """Sleep until the wall clock has caught up."""
        await asyncio.sleep(max(0.0, self._start + at / self._speed - time.perf_counter()))

    async def put_off(self, wait: float) -> None:
        """Let `wait` (s, of the wall) pass without mission time."""
        self._start += wait
        await asyncio.sleep(wait)


def date() -> float:
    """Return the computer's idea of the date (s since 1970): the one clock that outlives us."""
    return time.time()  # noqa: TID251 - a flight resumes in another process, perhaps after a reboot


def stopwatch() -> float:
    """Return wall time (s) from an arbitrary start."""
    return time.perf_counter()


def processor_time() -> float:
    """Return the time (s) that this thread has had a processor, from an arbitrary start."""
    return time.thread_time()
