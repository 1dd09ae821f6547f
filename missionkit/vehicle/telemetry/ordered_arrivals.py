"""Messages in the order they count, each with the mission time at which it was measured."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from missionkit.vehicle.link.clocks import BootClock, MissionClock
from missionkit.vehicle.link.message_cache import Cache, Fields, Message
from missionkit.vehicle.link.message_rates import CLOCKED, QUEUED, boot_time
from missionkit.vehicle.link.time_sync import Answer

STAMP_TOLERANCE = 0.05  # s that a stamp may lie after the arrival: the clocks are only estimated
LONGEST_TRANSIT = 1.0  # s that a sensor's message may have been on its way
FOREIGN = frozenset(  # not always stamped by the autopilot's clock; ArduPilot's flow is in ms
    ("DISTANCE_SENSOR", "OBSTACLE_DISTANCE", "OPTICAL_FLOW", "OPTICAL_FLOW_RAD")
)
Timed = tuple[Fields, float]
"""A message's fields and when it was measured (s)."""


class Arrivals:
    """Holds queued messages until they are due, and learns the vehicle's clock from them.

    What arrived after a tick was due waits for the next one, so that ticks that catch up after a
    stall see what they would have seen in time.

    Args:
        cache: the newest messages.
        clock: mission time.
        answers: returns those that came since the last call.
    """

    def __init__(
        self,
        cache: Cache,
        clock: MissionClock,
        answers: Callable[[], Iterable[Answer]] = tuple,
    ) -> None:
        self._cache = cache
        self._clock = clock
        self._answers = answers
        self._boot = BootClock()
        self._waiting: dict[str, list[Message]] = {name: [] for name in QUEUED}
        self._learnt: dict[str, Message] = {}

    def forget(self) -> None:
        """Restart with the clock of an autopilot that has rebooted."""
        self._boot.forget()
        self._waiting = {name: [] for name in QUEUED}

    def collect(self) -> None:
        """Take over what has arrived since the last call."""
        self._learn()
        for name in QUEUED:
            self._waiting[name].extend(self._cache.drain(name))

    def due(self, name: str, now: float) -> list[Timed]:
        """Return the queued messages of a name that were there by `now` (s)."""
        timed = [(message, self.mission_time(message)) for message in self._waiting[name]]
        due = [(message.fields, at) for message, at in timed if at is not None and at <= now]
        self._waiting[name] = [m for m, at in timed if at is None or at > now]
        return due

    def arrived(self, name: str, now: float) -> list[Timed]:
        """Return all queued messages of a name, which has no stamps, with when they arrived."""
        messages, self._waiting[name] = self._waiting[name], []
        timed = [(message.fields, self._clock.at(message.arrived)) for message in messages]
        return [(fields, now if at is None else min(at, now)) for fields, at in timed]

    def mission_time(self, message: Message) -> float | None:
        """Return when something was measured (s, mission), by its stamp or else by its arrival.

        Sensors may stamp by a clock of their own: a stamp of theirs that lies after the arrival or
        long before it counts as none.
        """
        boot, arrived = boot_time(message), self._clock.at(message.arrived)
        stamped = None if boot is None else self._boot.mission(boot)
        if stamped is None or arrived is None or message.name not in FOREIGN:
            return arrived if stamped is None else stamped
        return stamped if -STAMP_TOLERANCE <= arrived - stamped <= LONGEST_TRANSIT else arrived

    def _learn(self) -> None:
        for name in CLOCKED:
            message = self._cache.latest(name)
            if message is None or message is self._learnt.get(name):
                continue
            self._learnt[name] = message
            boot, arrived = boot_time(message), self._clock.at(message.arrived)
            if boot is not None and arrived is not None:
                self._boot.hear(boot, arrived)
        for answer in self._answers():
            requested_at = self._clock.at(answer.sent)
            if requested_at is not None:
                self._boot.answered(answer.boot, requested_at)
