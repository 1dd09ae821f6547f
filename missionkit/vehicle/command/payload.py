"""The payload: one actuator that is on while the mission says so.

Sent when it changes, and again until the autopilot has acknowledged it.
"""

from __future__ import annotations

from contextlib import suppress

from missionkit.vehicle.command.command_transaction import Acks, send_command
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.link.message_link import MessageLink

SET_ACTUATOR = 187  # MAV_CMD_DO_SET_ACTUATOR
RELEASED = 2.0  # s (of the vehicle) to wait for an acknowledgement at the end
REPEAT_AFTER = 0.5  # s (of the vehicle) until it is sent again


class Payload:
    """Switches the first actuator of the autopilot's payload group.

    Args:
        wire: the link.
        cache: the newest messages.
        pace: seconds of the vehicle in one of the wall.
    """

    def __init__(self, wire: MessageLink, cache: Cache, pace: float = 1.0) -> None:
        self._wire = wire
        self._cache = cache
        self._acks = Acks(cache)
        self._again = REPEAT_AFTER / pace
        self._pace = pace
        self._on = False  # as wanted
        self._asked: float | None = None  # s, wall, when the change was first sent
        self._sent = float("-inf")  # s, wall

    def release(self) -> None:
        """Switch it off if it is on, and wait a moment until that is acknowledged. Blocks."""
        if not self._on:
            return
        end = self._cache.wall() + RELEASED / self._pace
        self.want(None)
        while not self._acknowledged() and self._cache.wall() < end:
            self._cache.wait(self._acknowledged, self._again)
            self.want(None)

    def _acknowledged(self) -> bool:
        return self._asked is None or self._acks.since(SET_ACTUATOR, self._asked) is not None

    def want(self, name: str | None) -> None:
        """Take over what a tick wants: the actuator's name while it is to be on."""
        on, now = name is not None, self._cache.wall()
        if on != self._on:
            self._on, self._asked = on, now
        elif self._asked is None or now - self._sent < self._again:
            return
        if self._acknowledged():
            self._asked = None
            return
        self._sent = now
        with suppress(RuntimeError):  # no link: sent again until it is acknowledged
            send_command(self._wire, SET_ACTUATOR, (1.0 if on else -1.0,))
