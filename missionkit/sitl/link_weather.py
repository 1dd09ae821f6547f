"""One direction of a link, as the faults leave it: packets cut, lost, late or out of order."""

from __future__ import annotations

import heapq
from typing import Generic, Protocol, TypeVar

T = TypeVar("T")
REORDERING_DELAY = 0.06  # s, by which a reordered packet is overtaken at most


class Weather(Protocol):
    """Effect of faults on packets."""

    def delay(self, direction: str, now: float) -> float | None:
        """Return how late (s) a packet sent at `now` (s) arrives; `None`: it is lost."""


class Wire(Generic[T]):
    """A queue in the order of arrival."""

    def __init__(self, weather: Weather, direction: str) -> None:
        self._weather = weather
        self._direction = direction
        self._queue: list[tuple[float, int, T]] = []
        self._count = 0

    def put(self, packet: T, now: float) -> None:
        """Send a packet at `now` (s)."""
        late = self._weather.delay(self._direction, now)
        if late is not None:
            self._count += 1
            heapq.heappush(self._queue, (now + late, self._count, packet))

    def due(self, now: float) -> list[T]:
        """Return what has arrived by `now` (s), in the order of arrival."""
        arrived = []
        while self._queue and self._queue[0][0] <= now + 1e-9:
            arrived.append(heapq.heappop(self._queue)[2])
        return arrived
