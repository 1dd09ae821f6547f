"""Time of several flights in one event loop."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from missionkit.engine.clock import Pace, Unhurried


class Lockstep:
    """Lets the flight that is furthest behind go next, alone, until it waits again.

    The order depends on mission time and on the order of the flights alone, so that a fleet flies
    the same every time.

    Args:
        flights: their number.
        pace: lets mission time pass for all of them; as fast as possible by default.
        between: called with the time (s) that all flights have reached, each time that it grows.
    """

    def __init__(
        self,
        flights: int,
        pace: Pace | None = None,
        between: Callable[[float], None] = lambda _: None,
    ) -> None:
        self._pace = pace or Unhurried()
        self._between = between
        self._flying = set(range(flights))
        self._waiting: dict[int, tuple[float, asyncio.Future[None]]] = {}
        self._now = 0.0

    def pace(self, number: int) -> Pace:
        """Return the pace of one flight."""
        return _Place(self, number)

    async def until(self, number: int, at: float) -> None:
        """Return when it is a flight's turn.

        Args:
            number: of the flight.
            at: s, mission time that it waits for.
        """
        turn: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting[number] = at, turn
        self._give_turn()
        await turn
        await self._pace.until(at)

    def leave(self, number: int) -> None:
        """Go on without a flight that has ended, however it did."""
        self._flying.discard(number)
        self._waiting.pop(number, None)
        self._give_turn()

    def _give_turn(self) -> None:
        if not self._flying or self._waiting.keys() != self._flying:
            return
        number = min(self._waiting, key=lambda it: (self._waiting[it][0], it))
        at, turn = self._waiting.pop(number)
        if at > self._now:
            self._between(self._now)
            self._now = at
        turn.set_result(None)


class _Place:
    """Pace of one of the flights."""

    def __init__(self, steps: Lockstep, number: int) -> None:
        self._steps = steps
        self._number = number

    async def until(self, at: float) -> None:
        """Return when it is this flight's turn at mission time `at` (s)."""
        await self._steps.until(self._number, at)
