"""The latest of every message, with the wall time at which it arrived.

Filled by MAVSDK's own thread, so that it is up to date also while the event loop is stuck.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

Fields = Mapping[str, Any]
Wall = Callable[[], float]

KEPT = 4000  # messages of one name that wait to be read; older ones are dropped
ENOUGH = 0.02  # s between two polls of a waiting thread, should a notification be missed


@dataclass(frozen=True, slots=True)
class Message:
    """One message as it arrived."""

    name: str
    fields: Fields
    arrived: float  # s, wall clock

    def __getitem__(self, key: str) -> Any:
        """Return a field; a number that the autopilot marked as unknown is None."""
        return self.fields[key]


class Cache:
    """Latest messages by name, and queues of those of which every one counts.

    Args:
        wall: the wall clock (s).
        queued: names of the messages that are kept until they are drained.
    """

    def __init__(self, wall: Wall, queued: frozenset[str] = frozenset()) -> None:
        self.wall = wall
        self._latest: dict[str, Message] = {}
        self._queues: dict[str, deque[Message]] = {name: deque(maxlen=KEPT) for name in queued}
        self._changed = threading.Condition()
        self._listeners: list[Callable[[Message], None]] = []

    def listen(self, listener: Callable[[Message], None]) -> None:
        """Call `listener` with every message, on the thread that brings it."""
        self._listeners.append(listener)

    def put(self, name: str, fields: Fields) -> None:
        """Take a message in, stamped with the time now."""
        message = Message(name, fields, self.wall())
        with self._changed:
            self._latest[name] = message
            if name in self._queues:
                self._queues[name].append(message)
            self._changed.notify_all()
        for listener in self._listeners:
            listener(message)

    def latest(self, name: str, max_age: float | None = None) -> Message | None:
        """Return the newest message of a name, None if there is none or it is older than that."""
        message = self._latest.get(name)
        if message is None or max_age is None or self.wall() - message.arrived <= max_age:
            return message
        return None

    def drain(self, name: str) -> list[Message]:
        """Return the queued messages of a name and forget them."""
        queue = self._queues[name]
        with self._changed:
            messages = list(queue)
            queue.clear()
        return messages

    def forget(self) -> None:
        """Forget everything, as after a reboot of the vehicle."""
        with self._changed:
            self._latest.clear()
            for queue in self._queues.values():
                queue.clear()

    def wait(self, holds: Callable[[], bool], timeout: float) -> bool:
        """Block the calling thread until `holds()`, or for `timeout` (s); say whether it holds."""
        end = self.wall() + timeout
        with self._changed:
            while not holds():
                left = end - self.wall()
                if left <= 0.0:
                    return False
                self._changed.wait(min(left, ENOUGH))
        return True
