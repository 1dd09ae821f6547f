"""Read a flight record back, also one that ends in the middle because the writer was killed."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from mcap.exceptions import McapError
from mcap.records import Channel, McapRecord, Message
from mcap.stream_reader import CRCValidationError, StreamReader
from zstandard import ZstdError

from missionkit.errors import UsageError

MAGIC = b"\x89MCAP0\r\n"

# What the reader raises inside a record whose end is missing, or that was changed.
TRUNCATED = (McapError, CRCValidationError, ZstdError, struct.error, UnicodeDecodeError)


class RecordEntry(NamedTuple):
    """One message of a record."""

    topic: str
    at: float  # s, mission time
    data: dict[str, Any]


def read(path: Path, *topics: str) -> Iterator[RecordEntry]:
    """Yield the messages of a record in the order they were written.

    Args:
        path: the `flight.mcap` of a run.
        topics: only these; all when none is named.

    Raises:
        UsageError: `path` is not a flight record.
    """
    for topic, at, data in raw_messages(path):
        if not topics or topic in topics:
            yield RecordEntry(topic, at * 1e-9, json.loads(data))


def raw_messages(path: Path) -> Iterator[tuple[str, int, bytes]]:
    """Yield topic, time (ns) and undecoded JSON of each message that is complete.

    Raises:
        UsageError: `path` is not a flight record.
    """
    names: dict[int, str] = {}
    for record in whole_records(path):
        if isinstance(record, Channel):
            names[record.id] = record.topic
        elif isinstance(record, Message):
            yield names[record.channel_id], record.log_time, record.data


def whole_records(path: Path) -> Iterator[McapRecord]:
    """Yield the records up to the first that was cut short or changed.

    The last one is a `Footer` if and only if all of them are there.

    Raises:
        UsageError: `path` is not a flight record.
    """
    try:
        stream = path.open("rb")
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}") from error
    with stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise UsageError(f"{path}: this is not a flight record (MCAP)")
        records = iter(StreamReader(stream, skip_magic=True, validate_crcs=True).records)
        while True:
            try:
                record = next(records)
            except (StopIteration, *TRUNCATED):
                return
            yield record
