"""Where records go: what writes them may fail or wait, and the flight does neither.

Jobs of one sink are done in the order they were put. In a rehearsal they are done at once, since
mission time waits: records are complete. Over a vehicle a thread does them behind a bounded queue.
"""

from __future__ import annotations

import queue
import threading
from collections import deque
from collections.abc import Callable
from typing import NamedTuple, ParamSpec, Protocol

Job = Callable[[], None]
P = ParamSpec("P")

DISK_TIMEOUT = 5.0  # s that the end of a flight waits for the disk


class Reports:
    """Sentences about what failed, one for each thing that did. Any thread may add to them."""

    def __init__(self) -> None:
        self.all: list[str] = []
        self._fresh = deque[str]()
        self._named = set[str]()

    def add(self, what: str, why: str | Exception, then: str = "; the flight continues") -> None:
        """Report that `what` failed, unless that was reported before.

        Args:
            what: name of the part; a second failure of the same is not reported.
            why: a sentence, or what was raised.
            then: end of the sentence.
        """
        if what in self._named:
            return
        self._named.add(what)
        sentence = f"{what}: {_sentence(why)}{then}"
        self.all.append(sentence)
        self._fresh.append(sentence)

    def take(self) -> tuple[str, ...]:
        """Return what was added since the last call."""
        return tuple(self._fresh.popleft() for _ in range(len(self._fresh)))


def _sentence(why: str | Exception) -> str:
    if isinstance(why, OSError) and why.strerror:
        return f"{why.strerror} ({why.filename})" if why.filename else why.strerror
    return why if isinstance(why, str) else f"{type(why).__name__}: {why}"


def contained(what: str, call: Callable[P, None], reports: Reports) -> Callable[P, None]:
    """Return a call that reports what it raises and continues.

    Args:
        what: name of the part, for the report.
        call: its result is dropped.
        reports: collects the sentence.
    """

    def safe(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            call(*args, **kwargs)
        except Exception as error:  # noqa: BLE001 - whatever breaks here must not end a flight
            reports.add(what, error)

    return safe


class Sink(Protocol):
    """Takes jobs."""

    def put(self, job: Job) -> None:
        """Do a job, now or later; what it raises is reported."""

    def close(self) -> None:
        """Return when all jobs are done, or cannot be; closing twice does no harm."""


class Inline:
    """Does each job at once.

    Args:
        what: is written, for the report when that fails.
        reports: takes it.
        persistent: continue with the next job after one that failed.
    """

    def __init__(self, what: str, reports: Reports, *, persistent: bool = False) -> None:
        self._what = what
        self._reports = reports
        self._persistent = persistent
        self._failed = False

    def put(self, job: Job) -> None:
        """Do a job now."""
        if self._failed and not self._persistent:
            return
        try:
            job()
        except Exception as error:  # noqa: BLE001 - whatever breaks here must not end a flight
            self._failed = True
            self._reports.add(self._what, error)

    def close(self) -> None:
        """Nothing waits."""


class Background:
    """Does jobs on a thread of its own; putting one never waits.

    Args:
        what: is written, for the report when that fails.
        reports: takes it.
        room: jobs that may wait; what comes on top is dropped, and reported.
        newest: a job takes the place of one that waits, instead of being dropped.
        persistent: continue with the next job after one that failed.
    """

    def __init__(
        self,
        what: str,
        reports: Reports,
        *,
        room: int = 200,
        newest: bool = False,
        persistent: bool = False,
    ) -> None:
        self._what = what
        self._reports = reports
        self._newest = newest
        self._dropped = 0
        self._closed = False
        self._jobs = queue.Queue[Job | None](room)
        self._work = Inline(what, reports, persistent=persistent)
        self._thread = threading.Thread(target=self._run, name=what, daemon=True)
        self._thread.start()

    def put(self, job: Job) -> None:
        """Leave a job for the thread."""
        if self._closed:
            return
        if self._newest and self._jobs.full():
            self._pop()
        try:
            self._jobs.put_nowait(job)
        except queue.Full:
            self._dropped += 1
            self._reports.add(f"{self._what} has a gap", "the disk does not keep up")

    def close(self) -> None:
        """Wait for what is left; give up on a disk that does not answer."""
        if self._closed:
            return
        self._closed = True
        try:
            self._jobs.put(None, timeout=DISK_TIMEOUT)
        except queue.Full:
            pass
        else:
            self._thread.join(DISK_TIMEOUT)
        if self._thread.is_alive():
            why = f"the disk has not answered for {DISK_TIMEOUT:g} s"
            self._reports.add(f"the end of {self._what} is missing", why, then="")
        if self._dropped:
            lacking = f"{self._what} lacks {self._dropped} ticks"
            self._reports.add(lacking, "the disk did not keep up", then="")

    def _pop(self) -> None:
        try:
            self._jobs.get_nowait()
        except queue.Empty:
            return

    def _run(self) -> None:
        while (job := self._jobs.get()) is not None:
            self._work.put(job)


class Sinks(NamedTuple):
    """Where a flight's record, checkpoints, live view and journal go."""

    reports: Reports  # of what failed
    record: Sink
    checkpoints: Sink
    view: Sink
    journal: Sink

    def close(self) -> None:
        """Wait for all of them."""
        for sink in (self.record, self.checkpoints, self.view, self.journal):
            sink.close()


RECORD, CHECKPOINTS, VIEW = "the flight record", "checkpoints", "the live view"
JOURNAL = "the journal"
JOURNAL_ROOM = 2000  # ticks, of 2 kB each: 100 s of a disk that does not answer


def inline() -> Sinks:
    """Return sinks for a rehearsal: mission time waits for them."""
    reports = Reports()
    return Sinks(
        reports,
        Inline(RECORD, reports),
        Inline(CHECKPOINTS, reports, persistent=True),
        Inline(VIEW, reports),
        Inline(JOURNAL, reports),
    )


def background() -> Sinks:
    """Return sinks for a vehicle, which waits for nothing."""
    reports = Reports()
    return Sinks(
        reports,
        Background(RECORD, reports),
        Background(CHECKPOINTS, reports, room=1, newest=True, persistent=True),
        Background(VIEW, reports),
        Background(JOURNAL, reports, room=JOURNAL_ROOM),
    )
