"""The MCAP file itself: every topic registered, every message counted into the digest."""

from __future__ import annotations

import errno
import json
import os
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from mcap.writer import CompressionType, Writer

from missionkit.recorder.record_digest import Digest
from missionkit.recorder.topic_schemas import TOPICS

FLUSH_BYTES = 64 * 1024  # bytes that may wait for `flush`


def check_there(stream: BinaryIO) -> None:
    """Notice that the file of a stream has been removed.

    Raises:
        FileNotFoundError: it was.
    """
    if not os.fstat(stream.fileno()).st_nlink:
        raise FileNotFoundError(errno.ENOENT, "it was removed while being written", stream.name)


class Channels:
    """An open flight record."""

    def __init__(self, path: Path) -> None:
        self._stream = path.open("xb")
        self._writer = Writer(
            self._stream, chunk_size=FLUSH_BYTES, compression=CompressionType.ZSTD
        )
        self._writer.start(profile="", library="missionkit")
        self._digest = Digest()
        schemas: dict[str, int] = {}
        for topic in TOPICS:
            if topic.schema_name not in schemas:
                schemas[topic.schema_name] = self._writer.register_schema(
                    topic.schema_name, "jsonschema", json.dumps(topic.schema).encode()
                )
        self._ids = {
            topic.name: self._writer.register_channel(
                topic.name, "json", schemas[topic.schema_name]
            )
            for topic in TOPICS
        }

    def publish(self, topic: str, at: int, text: str) -> None:
        """Write one message: JSON `text` at mission time `at` (ns).

        Args:
            topic: registered before.
            at: ns.
            text: a JSON object.
        """
        data = text.encode()
        self._digest.add(topic, at, data)
        self._writer.add_message(self._ids[topic], at, data, at)

    def flush(self) -> None:
        """Hand all that was published to the operating system: a kill loses none of it.

        Raises:
            OSError: it cannot be written, or the file was removed.
        """
        self._writer.flush()  # type: ignore[no-untyped-call]
        check_there(self._stream)

    def abandon(self) -> None:
        """Close the file as it is, after an error: what was handed over can still be read."""
        with suppress(OSError):
            self._stream.close()

    def close(self) -> str:
        """Finish the file with its index and return the digest."""
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._stream.close()
        return self._digest.text()
