"""The journal of a flight: all that its ticks were given and what they decided, bit by bit.

One MCAP file beside the flight record. `/origin` comes first: the text of every file the flight
stands on. `/tick` is written at every tick: the observation, what its image showed, and the
decision. `/memory` is the flight's memory before the next tick, from which a replay can start.
`/class` names the fields of a class before its first instance, for versions whose class has more.
Values are written by `value_codec`: reading them runs nothing. A kill loses 0.1 s at most.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from missionkit.messages import Command, Fired, Imu, Observation, Record, Verdict
from missionkit.recorder import value_codec
from missionkit.recorder.json_fragments import nanoseconds
from missionkit.recorder.mcap_channels import McapFile
from missionkit.recorder.record_sinks import Job, Sink

JOURNAL_FILE = "journal.mcap"
ORIGIN, TICK, MEMORY, CLASS = "/origin", "/tick", "/memory", "/class"
VERSION = 1  # grows when what is written below changes
SIMULATOR = "simulator"  # the vehicle of a rehearsal
MEMORY_PERIOD = 5.0 - 1e-6  # s between two memories; a replay of 5 s is quick, a memory is large
FLUSH_TICKS = 2
CHUNK_BYTES = 1 << 20  # more than waits between two flushes


class JournalHead(NamedTuple):
    """What the flight stands on."""

    version: int
    origin: Any  # the run's order, and the text of every file it stands on
    vehicle: str  # `SIMULATOR`, or the address
    begins: bool  # the first tick is that of the mission, not of a resumed part
    arm_anyway: bool


class Decision(NamedTuple):
    """What one tick decided: a replay must decide the same."""

    state: str
    active: tuple[str, ...]
    verdicts: tuple[tuple[str, Verdict], ...]
    fired: tuple[Fired, ...]
    command: Command
    step_note: str
    done: bool


class JournalTick(NamedTuple):
    """One tick."""

    number: int  # counts from 0 without a gap
    observation: Observation  # without images; its inertial samples are in `imu`
    imu: npt.NDArray[np.float64]  # (N, 7): s, (3,) m/s², (3,) rad/s
    image: Any  # what an image showed; None: there was none, or it had no pixels
    decision: Decision


class JournalMemory(NamedTuple):
    """The flight's memory before a tick."""

    number: int  # of that tick
    now: float  # s, of the tick before
    memory: Any


def decision_of(record: Record) -> Decision:
    """Return what a tick decided."""
    return Decision(
        record.state,
        record.active,
        record.verdicts,
        record.fired,
        record.command,
        record.step_note,
        record.done,
    )


class ValueFile(McapFile):
    """An MCAP file of values, as text of `value_codec`.

    Args:
        path: does not exist yet.
        topics: of the values.
    """

    def __init__(self, path: Path, topics: Sequence[str]) -> None:
        super().__init__(path, CHUNK_BYTES)
        schema = self._writer.register_schema("missionkit.value", "jsonschema", b"{}")
        every = (CLASS, *topics)
        self._ids = {it: self._writer.register_channel(it, "json", schema) for it in every}
        self._described: frozenset[str] = frozenset()

    def write(self, topic: str, at: int, text: str) -> None:
        """Write one value.

        Args:
            topic: one of the file's.
            at: mission time, ns.
            text: of the value.
        """
        for name in sorted(value_codec.classes_in(text) - self._described):
            self._described |= {name}
            self._add(CLASS, at, json.dumps({name: value_codec.field_names(name)}))
        self._add(topic, at, text)

    def _add(self, topic: str, at: int, text: str) -> None:
        self._writer.add_message(self._ids[topic], at, text.encode(), at)


class FlightJournal:
    """Writes the journal of one flight, tick by tick; errors end the journal, not the flight.

    Args:
        path: does not exist yet.
        head: comes first.
        take_image: returns what the image of this tick showed, None without one.
        sink: does the writing.
    """

    def __init__(
        self, path: Path, head: JournalHead, take_image: Callable[[], Any], sink: Sink
    ) -> None:
        self._take_image = take_image
        self._sink = sink
        self._count = 0
        self._remembered = -float("inf")
        self._file = ValueFile(path, (ORIGIN, TICK, MEMORY))
        self._put(lambda: self._write(ORIGIN, 0.0, head))

    def observe(self, record: Record, observation: Observation) -> None:
        """Keep one tick; an observer of the flight."""
        number, image = self._count, self._take_image()
        self._count += 1
        self._put(lambda: self._tick(number, record, observation, image))

    def keep(self, memory: Any, now: float) -> None:
        """Keep the flight's memory after a tick, when it is due.

        Args:
            memory: immutable.
            now: s.
        """
        if now - self._remembered < MEMORY_PERIOD:
            return
        self._remembered = now
        following = JournalMemory(self._count, now, memory)
        self._put(lambda: self._memory(following))

    def close(self) -> None:
        """Finish the file."""
        self._put(self._file.finish)
        self._sink.close()

    def _put(self, job: Job) -> None:
        self._sink.put(self._file.abandoned_on_error(job))

    def _tick(self, number: int, record: Record, observation: Observation, image: Any) -> None:
        tick = JournalTick(
            number, without_samples(observation), rows(observation), image, decision_of(record)
        )
        self._write(TICK, record.now, tick)
        if number % FLUSH_TICKS == 0:
            self._file.flush()

    def _memory(self, following: JournalMemory) -> None:
        with suppress(value_codec.NotPlainError):  # of a plug-in: a replay starts elsewhere
            self._write(MEMORY, following.now, following)

    def _write(self, topic: str, now: float, value: Any) -> None:
        self._file.write(topic, nanoseconds(now), value_codec.written(value))


def rows(observation: Observation) -> npt.NDArray[np.float64]:
    """Return the inertial samples as one array (N, 7): a twentieth of the text."""
    samples = [(it.at, *it.accel.tolist(), *it.gyro.tolist()) for it in observation.imu]
    return np.array(samples).reshape(-1, 7)


def without_samples(observation: Observation) -> Observation:
    """Return an observation without images and inertial samples."""
    frame = observation.frame
    return replace(observation, imu=(), frame=None if frame is None else frame._replace(image=None))


def whole(tick: JournalTick) -> Observation:
    """Return the observation of a tick, without its image."""
    samples = tuple(Imu(float(row[0]), row[1:4], row[4:7]) for row in tick.imu)
    return replace(tick.observation, imu=samples)
