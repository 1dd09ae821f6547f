"""Three clocks: the wall, the mission, and the vehicle's time since boot.

Imported where time is needed; the wall clock is read here and nowhere else in the adapter.
"""

from __future__ import annotations

import math
import threading
import time
from collections import deque

REMEMBERED = 300  # messages whose delay is looked at: the least of them is the link's own
ANSWERS = 5  # of the vehicle to the question for its time, that count
SLACK = (
    0.2  # s by which the vehicle's time may fall behind, to catch up again, before it is followed
)
AGREED = 0.05  # s by which answers and messages may disagree if they are stamped by one clock


def wall() -> float:
    """Return wall time (s) from an arbitrary start; it advances while the process is stopped."""
    return time.perf_counter()


def unix() -> float:
    """Return the computer's idea of the date (s since 1970)."""
    return time.time()  # noqa: TID251 - compared with the vehicle's date before a flight


class MissionClock:
    """Mission time as a function of wall time, learnt from the ticks.

    A tick comes at its mission time or later, never earlier: the earliest one seen is right.
    """

    def __init__(self, speed: float = 1.0) -> None:
        self.speed = speed
        self._offset: float | None = None

    def tick(self, now: float, at: float) -> None:
        """Learn from a tick of mission time `now` (s) that came at wall time `at` (s)."""
        offset = now - at * self.speed
        if self._offset is None or offset > self._offset:
            self._offset = offset

    def put_off(self, wait: float) -> None:
        """Forget that `wait` (s, of the wall) have passed: mission time stood still."""
        if self._offset is not None:
            self._offset -= wait * self.speed

    def at(self, wall_time: float) -> float | None:
        """Return the mission time (s) at a wall time, None before the first tick."""
        return None if self._offset is None else wall_time * self.speed + self._offset

    def wall(self, mission_time: float) -> float | None:
        """Return the wall time (s) at a mission time, None before the first tick."""
        return None if self._offset is None else (mission_time - self._offset) / self.speed


class BootClock:
    """Mission time of what the vehicle stamped with its time since boot.

    Each message gives an upper limit to the offset between the clocks, its delay; the smallest
    of the last ones counts, so that jitter on the link does not become jitter of the sensors. It
    is too small where the vehicle's time passes more slowly than ours. Each answer to the question
    for its time gives a lower limit: it was stamped after it was requested. The offset is at most
    `SLACK` less than that.
    """

    def __init__(self) -> None:
        self._count = 0
        self._least: deque[tuple[int, float]] = deque()  # (message, offset), offsets rising
        self._floors: deque[float] = deque(maxlen=ANSWERS)  # lower limits of the offset
        self._lock = threading.Lock()  # cameras ask from their own threads

    def hear(self, boot: float, arrived: float) -> None:
        """Learn from a message stamped `boot` (s) that arrived at mission time `arrived` (s)."""
        offset = arrived - boot
        with self._lock:
            while self._least and self._least[-1][1] >= offset:
                self._least.pop()
            self._least.append((self._count, offset))
            for n, floor in enumerate(self._floors):
                self._floors[n] = min(floor, offset)  # a simulation has caught up
            self._count += 1
            if self._least[0][0] <= self._count - 1 - REMEMBERED:
                self._least.popleft()

    def answered(self, boot: float, requested_at: float) -> None:
        """Learn from an answer stamped `boot` (s) to a request sent at `requested_at` (s).

        One that contradicts the newest message is of another clock.
        """
        floor = requested_at - boot
        with self._lock:
            newest = self._least[-1][1] if self._least else -math.inf
            if floor <= newest + AGREED:
                self._floors.append(min(floor, newest))

    def forget(self) -> None:
        """Restart: the vehicle has rebooted."""
        with self._lock:
            self._least.clear()
            self._floors.clear()

    def mission(self, boot: float) -> float | None:
        """Return the mission time (s) of a stamp, None before the first message."""
        with self._lock:
            if not self._least:
                return None
            floor = max(self._floors, default=-math.inf) - SLACK
            return max(self._least[0][1], floor) + boot
