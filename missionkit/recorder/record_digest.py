"""One number that two flights share exactly when everything recorded was the same."""

from __future__ import annotations

import hashlib
from pathlib import Path

from missionkit.recorder.record_reader import raw_messages
from missionkit.recorder.topic_schemas import WALL_CLOCK


class Digest:
    """SHA-256 over (topic, time, data) of each message, in order, wall-clock topics left out."""

    def __init__(self) -> None:
        self._sum = hashlib.sha256()

    def add(self, topic: str, at: int, data: bytes) -> None:
        """Take in one message; `at` in ns.

        Args:
            topic: those with wall-clock times do not count.
            at: mission time, ns.
            data: the whole message.
        """
        if topic not in WALL_CLOCK:
            self._sum.update(b"%s %d %d\n%b" % (topic.encode(), at, len(data), data))

    def text(self) -> str:
        """Return the digest so far, 64 hexadecimal digits."""
        return self._sum.hexdigest()


def hash_of(path: Path) -> str:
    """Return the digest of a flight record on disk: what `FlightRecorder.close` returned.

    Raises:
        UsageError: `path` is not a flight record.
    """
    digest = Digest()
    for topic, at, data in raw_messages(path):
        digest.add(topic, at, data)
    return digest.text()
