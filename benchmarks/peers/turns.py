"""Timing several things in turns, so that all see the same machine; and what things keep."""

from __future__ import annotations

import gc
import tracemalloc
from collections.abc import Callable, Mapping
from statistics import median

from benchmarks.measure import seconds

Work = Callable[[], object]
ROUNDS = 9  # samples of each
SAMPLE = 0.01  # s of work in one sample


def medians(
    works: Mapping[str, Work], *, rounds: int = ROUNDS, collecting: bool = False
) -> dict[str, float]:
    """Return the processor time (s) that each takes; with garbage collection if wanted."""
    counts = {name: _count(work) for name, work in works.items()}
    times: dict[str, list[float]] = {name: [] for name in works}
    gc.collect()
    if not collecting:
        gc.disable()
    try:
        for _ in range(rounds):
            for name, work in works.items():
                times[name].append(seconds(_repeated, work, counts[name]) / counts[name])
    finally:
        gc.enable()
    return {name: median(took) for name, took in times.items()}


def _count(work: Work) -> int:
    """Return how often to do something in one sample; does it twice, to warm up and to time."""
    work()
    once = seconds(work)
    if once > SAMPLE / 10:
        return max(1, int(SAMPLE / once))
    return max(1, int(10 * SAMPLE / seconds(_repeated, work, 10)))


def _repeated(work: Work, times: int) -> None:
    for _ in range(times):
        work()


def kept(make: Work) -> int:
    """Return how many bytes what is made keeps."""
    gc.collect()
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        made = make()
        gc.collect()
        after = tracemalloc.get_traced_memory()[0]
        del made
    finally:
        tracemalloc.stop()
    return after - before
