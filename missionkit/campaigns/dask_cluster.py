"""Runs on a Dask cluster: the only importer of dask.

Every worker needs missionkit and the same files under the same paths. A run is given to a worker
when one of its threads is free, so that the time limit counts flying only.
"""

from __future__ import annotations

import logging
from collections.abc import Generator, Iterable, Mapping
from concurrent.futures import CancelledError
from contextlib import suppress
from importlib import import_module
from typing import Any

from missionkit.campaigns.run_row import (
    Case,
    Row,
    RunOrder,
    unflown,
)
from missionkit.campaigns.single_run import fly
from missionkit.engine.clock import stopwatch
from missionkit.errors import UsageError, VehicleError

CONNECTING = 10.0  # s
LOOKING = 0.5  # s between two looks at the clock


def flown(
    order: RunOrder, cases: Iterable[Case], *, address: str, timeout: float = 300.0
) -> Generator[Row, None, None]:
    """Fly and yield rows as they end.

    A worker that dies is the cluster's to replace: it flies the run again elsewhere. One that
    hangs is restarted.

    Args:
        order: what the runs share.
        cases: taken from as threads become free.
        address: of the scheduler, such as tcp://127.0.0.1:8786.
        timeout: s of wall time that a run may take.

    Raises:
        UsageError: dask.distributed is not installed.
        VehicleError: no cluster answers there, or it has gone; the rows so far stay.
    """
    dask = _dask()
    with _client(dask, address) as client:
        try:
            yield from _rows(dask, client, order, cases, timeout)
        except (OSError, TimeoutError, CancelledError) as error:
            raise _gone(address, error) from error


def _rows(
    dask: Any, client: Any, order: RunOrder, cases: Iterable[Case], timeout: float
) -> Generator[Row, None, None]:
    waiting, flying = iter(cases), dict[Any, tuple[Case, float]]()
    while True:
        while len(flying) < _threads(client) and (case := next(waiting, None)) is not None:
            future = client.submit(fly, order, case, pure=False)
            flying[future] = case, stopwatch() + timeout
        if not flying:
            return
        for future in _ended(dask, flying):
            case, deadline = flying[future]
            if future.done():
                del flying[future]
                yield _row(future, case)
            elif deadline <= stopwatch():
                del flying[future]
                _stop(client, future)
                yield unflown(case, "hung", f"no result within {timeout:g} s")


def _gone(address: str, error: BaseException) -> VehicleError:
    why = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    return VehicleError(
        f"lost the Dask cluster at {address} ({why}); finished runs are kept: "
        "repeat the command to fly the rest"
    )


def _dask() -> Any:
    try:
        dask = import_module("distributed")
    except ImportError as error:
        hint = "--cluster needs dask.distributed: pip install 'missionkit[cluster]'"
        raise UsageError(hint) from error
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)  # a sentence says it
    return dask


def _client(dask: Any, address: str) -> Any:
    try:
        return dask.Client(address, timeout=CONNECTING)
    except (OSError, ValueError) as error:
        raise VehicleError(f"no Dask cluster answers at {address}: {error}") from error


def _threads(client: Any) -> int:
    """Return how many runs fit at a time, one at least: workers may still come."""
    threads: dict[str, int] = client.nthreads()
    return max(1, sum(threads.values()))


def _ended(dask: Any, flying: Mapping[Any, tuple[Case, float]]) -> list[Any]:
    """Wait for a moment; return the runs that have ended or are out of time."""
    try:
        dask.wait(list(flying), timeout=LOOKING, return_when="FIRST_COMPLETED")
    except TimeoutError:
        now = stopwatch()
        return [it for it, (_, deadline) in flying.items() if it.done() or deadline <= now]
    return [future for future in flying if future.done()]


def _row(future: Any, case: Case) -> Row:
    error = future.exception()
    if error is None:
        row: Row = future.result()
        return row
    what = type(error).__name__
    died = what == "KilledWorker"  # its own words differ from run to run
    why = "every worker that flew it died" if died else f"{what}: {error}"
    return unflown(case, "lost", f"the cluster gave up on it: {why}")


def _stop(client: Any, future: Any) -> None:
    """Restart the worker that hangs; nothing else ends a thread."""
    workers = [name for names in client.who_has([future]).values() for name in names]
    processing = client.processing()
    workers += [name for name, keys in processing.items() if future.key in keys]
    future.cancel(force=True)
    with suppress(ValueError):  # a worker without a nanny stays as it is
        client.restart_workers(sorted(set(workers)), raise_for_error=False)
