"""The flights of a study, several at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TypeVar

T = TypeVar("T")
R = TypeVar("R")


def in_parallel(
    run: Callable[[T], R], orders: Sequence[T], workers: int, chunk: int = 1
) -> Iterator[R]:
    """Yield the result of each order, in order; with one worker they run in this process.

    Args:
        run: a function of a module, or a `partial` of one.
        orders: what it is called with.
        workers: processes.
        chunk: orders that a process takes at a time.
    """
    if workers == 1:
        yield from map(run, orders)
        return
    with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
        yield from pool.map(run, orders, chunksize=chunk)
