"""Reading a journal back, also one that ends in the middle because its writer was killed."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from mcap.records import Channel, Footer, Message
from pydantic import TypeAdapter, ValidationError

from missionkit.errors import UsageError
from missionkit.recorder import value_codec
from missionkit.recorder.flight_journal import (
    CLASS,
    MEMORY,
    ORIGIN,
    TICK,
    VERSION,
    JournalHead,
    JournalMemory,
    JournalTick,
)
from missionkit.recorder.record_reader import MAGIC, whole_records
from missionkit.recorder.value_codec import Fields, NotReadableError

T = TypeVar("T")


class Journal(NamedTuple):
    """A journal on disk: where it can be replayed from, and its ticks as text."""

    path: Path
    head: JournalHead
    ticks: tuple[tuple[float, bytes], ...]  # s, and the text of each tick
    memories: tuple[tuple[float, bytes], ...]  # s of the tick before, and the text of each memory
    ends: str = ""  # why it ends before the flight did; "": it is whole
    read: Callable[[str], Any] = value_codec.read  # knows the fields of the classes it holds


def read_journal(path: Path) -> Journal:
    """Return the usable part of a journal.

    Raises:
        UsageError: it is not one, or another version of missionkit wrote it.
    """
    texts: dict[str, list[tuple[float, bytes]]] = {ORIGIN: [], TICK: [], MEMORY: []}
    topics: dict[int, str] = {}
    classes: dict[str, Fields] = {}
    ended = False
    for record in whole_records(path):
        ended = isinstance(record, Footer)
        if isinstance(record, Channel):
            topics[record.id] = record.topic
        elif isinstance(record, Message):
            topic = topics[record.channel_id]
            if topic == CLASS:
                classes.update(_classes(path, record.data))
            elif topic in texts:
                texts[topic].append((record.log_time * 1e-9, record.data))
    if not texts[ORIGIN]:
        raise UsageError(f"{path}: this is not the journal of a flight: it names no mission")
    read = value_codec.reader(classes)
    head, ticks = _head(path, texts[ORIGIN][0][1], read), tuple(texts[TICK])
    ends = "" if ended else _ends(path, ticks)
    return Journal(path, head, ticks, tuple(texts[MEMORY]), ends, read)


def _classes(path: Path, text: bytes) -> dict[str, Fields]:
    """Return the names of the fields of classes, by class."""
    try:
        return TypeAdapter(dict[str, Fields]).validate_json(text)
    except ValidationError as error:
        raise UsageError(f"{path}: the fields of a class were changed after the flight") from error


def _ends(path: Path, ticks: Sequence[tuple[float, bytes]]) -> str:
    until = f"at {ticks[-1][0]:.2f} s" if ticks else "before its first tick"
    with path.open("rb") as stream:
        stream.seek(-len(MAGIC), os.SEEK_END)
        if stream.read() == MAGIC:
            return f"{path}: it can be read up to {until.removeprefix('at ')}: the rest is damaged"
    return f"{path}: it ends {until}: the flight goes on, or was killed, or the file was cut short"


def tick_of(journal: Journal, text: bytes) -> JournalTick:
    """Return a tick.

    Raises:
        UsageError: the text is none.
    """
    changed = "a tick was changed after the flight"
    return _kept(journal.path, text, JournalTick, changed, journal.read)


def memory_of(journal: Journal, text: bytes) -> JournalMemory:
    """Return a memory.

    Raises:
        UsageError: the text is none.
    """
    changed = "a memory was changed after the flight"
    return _kept(journal.path, text, JournalMemory, changed, journal.read)


def _head(path: Path, text: bytes, read: Callable[[str], Any]) -> JournalHead:
    value = _kept(path, text, JournalHead, "this is not the journal of a flight", read)
    if value.version != VERSION:
        raise UsageError(
            f"{path}: another version of missionkit wrote this journal (format {value.version}; "
            f"this one reads {VERSION})"
        )
    return value


def _kept(path: Path, text: bytes, kind: type[T], otherwise: str, read: Callable[[str], Any]) -> T:
    """Return a value of a kind; `otherwise` says what is wrong with any other."""
    try:
        value = read(text.decode())
    except (UnicodeDecodeError, NotReadableError) as error:
        raise UsageError(f"{path}: it cannot be read: {error}") from error
    if not isinstance(value, kind):
        raise UsageError(f"{path}: {otherwise}")
    return value
