"""Runs on processes of this machine.

A worker that hangs or dies costs its run at most: it is killed where needed and replaced. A run
whose worker died is flown once more, since the cause may have been outside of it; the second death
is a row. Workers are forked from one process that has everything imported and compiled.
"""

from __future__ import annotations

import faulthandler
import multiprocessing
import os
import signal
from collections import deque
from collections.abc import Generator, Iterable
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import NamedTuple

from missionkit.campaigns.run_row import (
    Case,
    Row,
    RunOrder,
    unflown,
)
from missionkit.engine.clock import stopwatch

LOSSES = 2  # workers that a run may cost
STARTING = 120.0  # s that importing everything may take
TIME_LIMIT_GRACE = 5.0  # s that a worker survives past its time limit unless it is killed

_processes = multiprocessing.get_context("forkserver")


def flown(
    order: RunOrder, cases: Iterable[Case], *, workers: int = 2, timeout: float = 300.0
) -> Generator[Row, None, None]:
    """Fly and yield rows as they end; closing the generator ends the workers.

    Args:
        order: what the runs share.
        cases: taken from as workers become free.
        workers: processes.
        timeout: s of wall time that a run may take.
    """
    _processes.set_forkserver_preload(["missionkit.campaigns.worker_preload"])
    tasks, crew = _Tasks(cases), list[_Worker]()
    try:
        while True:
            while len(crew) < workers and (task := tasks.take()) is not None:
                crew.append(_Worker(order, timeout, task))
            if not crew:
                return
            for worker in _due(crew):
                row = worker.outcome()
                if row is None:
                    tasks.again(worker.task)
                else:
                    yield row
                _go_on(worker, tasks, crew)
    finally:
        for worker in crew:
            worker.end()


def _go_on(worker: _Worker, tasks: _Tasks, crew: list[_Worker]) -> None:
    """Give a worker its next task; one that has died or has nothing to do leaves."""
    task = tasks.take() if worker.alive else None
    if task is None:
        worker.end()
        crew.remove(worker)
    else:
        worker.give(task)


class _Task(NamedTuple):
    """A run to be flown."""

    case: Case
    losses: int = 0  # workers that died over it


class _Tasks:
    """Queue of runs; those that lost their worker come first."""

    def __init__(self, cases: Iterable[Case]) -> None:
        self._cases = iter(cases)
        self._again = deque[_Task]()

    def take(self) -> _Task | None:
        if self._again:
            return self._again.popleft()
        case = next(self._cases, None)
        return None if case is None else _Task(case)

    def again(self, task: _Task) -> None:
        self._again.append(task._replace(losses=task.losses + 1))


class _Worker:
    """A process and the run it is at."""

    def __init__(self, order: RunOrder, timeout: float, task: _Task) -> None:
        self.alive = True
        self.pipe, theirs = _processes.Pipe()
        self._timeout = timeout
        self._process = _processes.Process(
            target=_work, args=(theirs, order, timeout + TIME_LIMIT_GRACE), daemon=True
        )
        self._process.start()
        theirs.close()
        with suppress(EOFError, OSError):  # it died at once: its first run will tell
            if self.pipe.poll(STARTING):
                self.pipe.recv()
        self.give(task)

    def give(self, task: _Task) -> None:
        """Let it fly the next run."""
        self.task = task
        self.deadline = stopwatch() + self._timeout
        with suppress(OSError):  # it died between two runs: reading will tell
            self.pipe.send(task.case)

    def outcome(self) -> Row | None:
        """Return the row of a run that is due; `None`: the worker died, and it is worth a retry."""
        try:
            if self.pipe.poll():
                row: Row = self.pipe.recv()
                return row
        except (EOFError, OSError):
            return self._died()
        self.alive = False
        return unflown(self.task.case, "hung", f"no result within {self._timeout:g} s")

    def _died(self) -> Row | None:
        self.alive = False
        self._process.join()
        if self.task.losses + 1 < LOSSES:
            return None
        code = self._process.exitcode or 0
        how = f"exit code {code}" if code >= 0 else f"signal {signal.Signals(-code).name}"
        return unflown(self.task.case, "lost", f"the process that flew it died, {how}")

    def end(self) -> None:
        """Kill it, unless it has gone."""
        self._process.kill()
        self._process.join()
        self._process.close()
        self.pipe.close()


def _due(crew: list[_Worker]) -> list[_Worker]:
    """Wait until a worker has answered, died or run out of time; return all such."""
    patience = max(0.0, min(worker.deadline for worker in crew) - stopwatch())
    ready = wait([worker.pipe for worker in crew], patience)
    now = stopwatch()
    return [worker for worker in crew if worker.pipe in ready or worker.deadline <= now]


def _work(pipe: Connection, order: RunOrder, limit: float) -> None:
    """Fly what comes through the pipe until it is closed."""
    from missionkit.campaigns.single_run import fly  # noqa: PLC0415 - heavy, and only workers need it

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to answer
    with Path(os.devnull).open("w") as nowhere, suppress(EOFError, OSError):
        pipe.send("ready")
        while True:
            case = pipe.recv()
            faulthandler.dump_traceback_later(limit, exit=True, file=nowhere)
            row = fly(order, case)
            faulthandler.cancel_dump_traceback_later()
            pipe.send(row)
