"""The MCAP file itself: every topic registered, every message counted into the digest."""

from __future__ import annotations

import errno
import json
import os
from contextlib import suppress
from pathlib import Path

from mcap.writer import CompressionType, Writer

from missionkit.recorder.record_digest import Digest
from missionkit.recorder.record_sinks import Job
from missionkit.recorder.topic_schemas import TOPICS

FLUSH_BYTES = 64 * 1024  # bytes that may wait for `flush`


class McapFile:
    """An open MCAP file.

    Args:
        path: does not exist yet.
        chunk_size: bytes that may wait for `flush`.
    """

    def __init__(self, path: Path, chunk_size: int) -> None:
        self._stream = path.open("xb")
        self._writer = Writer(self._stream, chunk_size=chunk_size, compression=CompressionType.ZSTD)
        self._writer.start(profile="", library="missionkit")

    def flush(self) -> None:
        """Hand all that was written to the operating system: a kill loses none of it.

        Raises:
            OSError: it cannot be written, or the file was removed.
        """
        self._writer.flush()  # type: ignore[no-untyped-call]
        if not os.fstat(self._stream.fileno()).st_nlink:
            why = "it was removed while being written"
            raise FileNotFoundError(errno.ENOENT, why, self._stream.name)

    def abandoned_on_error(self, job: Job) -> Job:
        """Return a job after whose error the file is closed as it is: it can still be read."""

        def write() -> None:
            try:
                job()
            except BaseException:
                with suppress(OSError):
                    self._stream.close()
                raise

        return write

    def finish(self) -> None:
        """Write the index, and close the file."""
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._stream.close()


class Channels(McapFile):
    """An open flight record."""

    def __init__(self, path: Path) -> None:
        super().__init__(path, FLUSH_BYTES)
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

    def close(self) -> str:
        """Finish the file with its index and return the digest."""
        self.finish()
        return self._digest.text()
