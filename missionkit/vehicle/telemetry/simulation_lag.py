"""How far a simulated autopilot has fallen behind mission time.

Its clock is the simulation's, which passes more slowly than the wall on a busy machine. Mission
time that ran on would see sensors fall silent and commands come late; it waits instead.
"""

from __future__ import annotations

import math

from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.link.message_rates import CLOCKED, boot_time


class SimulationLag:
    """Compares the newest stamp of the vehicle with mission time.

    Args:
        cache: the newest messages.
    """

    def __init__(self, cache: Cache) -> None:
        self._cache = cache
        self._newest = -math.inf  # s since boot
        self._least = math.inf  # s, mission time less time since boot: the delay of the link

    def at(self, now: float) -> float:
        """Return the lag (s) at mission time `now`.

        It is 0 where no message has come since the last call: silence has to be noticed.
        """
        messages = [self._cache.latest(name) for name in CLOCKED]
        stamps = [boot_time(it) for it in messages if it is not None]
        newest = max((it for it in stamps if it is not None), default=self._newest)
        if newest == self._newest:
            return 0.0
        if newest < self._newest:  # it has rebooted
            self._least = math.inf
        self._newest = newest
        self._least = min(self._least, now - newest)
        return now - newest - self._least
