"""Reading a journal back, also one that ends in the middle because its writer was killed."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

from mcap.records import Channel, Footer, Message

from missionkit.errors import UsageError
from missionkit.recorder import value_codec
from missionkit.recorder.flight_journal import (
    MEMORY,
    ORIGIN,
    TICK,
    VERSION,
    JournalHead,
    JournalMemory,
    JournalTick,
)
from missionkit.recorder.record_reader import MAGIC, whole_records
from missionkit.recorder.value_codec import NotReadableError

T = TypeVar("T")


class Journal(NamedTuple):
    """A journal on disk: where it can be replayed from, and its ticks as text."""

    path: Path
    head: JournalHead
    ticks: tuple[tuple[float, bytes], ...]  # s, and the text of each tick
    memories: tuple[tuple[float, bytes], ...]  # s of the tick before, and the text of each memory
    ends: str = ""  # why it ends before the flight did; "": it is whole


def read_journal(path: Path) -> Journal:
    """Return the usable part of a journal.

    Raises:
        UsageError: it is not one, or another version of missionkit wrote it.
    """
    ticks: list[tuple[float, bytes]] = []
    memories: list[tuple[float, bytes]] = []
    head: JournalHead | None = None
    topics: dict[int, str] = {}
    ended = False
    for record in whole_records(path):
        ended = isinstance(record, Footer)
        if isinstance(record, Channel):
            topics[record.id] = record.topic
        if not isinstance(record, Message):
            continue
        topic, at, data = topics[record.channel_id], record.log_time * 1e-9, record.data
        if topic == ORIGIN and head is None:
            head = _head(path, data)
        elif topic == TICK:
            ticks.append((at, data))
        elif topic == MEMORY:
            memories.append((at, data))
    if head is None:
        raise UsageError(f"{path}: this is not the journal of a flight: it names no mission")
    ends = "" if ended else _ends(path, ticks)
    return Journal(path, head, tuple(ticks), tuple(memories), ends)


def _ends(path: Path, ticks: Sequence[tuple[float, bytes]]) -> str:
    until = f"at {ticks[-1][0]:.2f} s" if ticks else "before its first tick"
    with path.open("rb") as stream:
        stream.seek(-len(MAGIC), os.SEEK_END)
        if stream.read() == MAGIC:
            return f"{path}: it can be read up to {until.removeprefix('at ')}: the rest is damaged"
    return f"{path}: it ends {until}: the flight was killed, or the file was cut short"


def tick_of(path: Path, text: bytes) -> JournalTick:
    """Return a tick.

    Raises:
        UsageError: the text is none.
    """
    return _kept(path, text, JournalTick, "a tick was changed after the flight")


def memory_of(path: Path, text: bytes) -> JournalMemory:
    """Return a memory.

    Raises:
        UsageError: the text is none.
    """
    return _kept(path, text, JournalMemory, "a memory was changed after the flight")


def _head(path: Path, text: bytes) -> JournalHead:
    value = _kept(path, text, JournalHead, "this is not the journal of a flight")
    if value.version != VERSION:
        raise UsageError(
            f"{path}: another version of missionkit wrote this journal (format {value.version}; "
            f"this one reads {VERSION})"
        )
    return value


def _kept(path: Path, text: bytes, kind: type[T], otherwise: str) -> T:
    """Return a value of a kind; `otherwise` says what is wrong with any other."""
    try:
        value = value_codec.read(text.decode())
    except (UnicodeDecodeError, NotReadableError) as error:
        raise UsageError(f"{path}: it cannot be read: {error}") from error
    if not isinstance(value, kind):
        raise UsageError(f"{path}: {otherwise}")
    return value
