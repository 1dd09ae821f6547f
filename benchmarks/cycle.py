"""One cycle of the loop: sense, process and control, detection on 640x480 included."""

from __future__ import annotations

import time

import numpy as np
import numpy.typing as npt

from benchmarks.flights import ready, warm_up
from benchmarks.measure import Table, spread
from missionkit.engine.clock import stopwatch
from missionkit.engine.prepared_mission import begin
from missionkit.engine.tick import tick
from missionkit.plugin_containment import Containment

SEEDS = range(1, 4)
BUDGET, GOAL = 50.0, 25.0  # ms
HEADER = ("part", "p50, ms", "p99, ms", "p50 of processor, ms", "p99 of processor, ms")


class Clocks:
    """A stopwatch for the tick that reads two clocks: on the wall and of the processor."""

    def __init__(self) -> None:
        self.marks: list[tuple[float, float]] = []

    def __call__(self) -> float:
        """Note both times (s)."""
        self.marks.append((stopwatch(), time.thread_time()))
        return 0.0


def tables() -> list[Table]:
    """Time every tick of whole missions with a rendered camera."""
    warm_up()
    parts = np.concatenate([_parts(seed) for seed in SEEDS])
    whole = parts.sum(axis=1)
    named = zip(("sense", "process", "control"), parts.transpose(1, 0, 2), strict=True)
    rows = [_row(name, part) for name, part in (*named, ("whole cycle", whole))]
    p99 = 1e3 * float(np.percentile(whole[:, 0], 99))
    late = int((whole[:, 0] > 1e-3 * BUDGET).sum())
    note = (
        f"{len(parts)} ticks of {len(SEEDS)} precision tasks, each tick with a 640x480 frame. "
        f"On the wall p99 of the whole cycle is {p99 / BUDGET:.2f} of P1's budget of "
        f"{BUDGET:.0f} ms and {p99 / GOAL:.2f} of the goal of {GOAL:.0f} ms; {late} ticks took "
        f"longer than {BUDGET:.0f} ms. Processor time leaves out what other processes took."
    )
    return [Table("Cycle", HEADER, rows, note)]


def _parts(seed: int) -> npt.NDArray[np.float64]:
    """Fly once; return the time (s) of each part of each tick, (ticks, 3 parts, 2 clocks)."""
    at, clocks = ready("rendered", seed), Clocks()
    memory, contain, count, landed = begin(at.plan), Containment(), 0, False
    while not landed:
        count += 1
        observation = at.vehicle.advance(count * at.plan.period)
        done = tick(at.plan, memory, observation, contain, clocks)
        at.vehicle.apply(done.command)
        memory = done.memory
        landed = done.record.state == "land" and memory.acting.done
    marks = np.array(clocks.marks).reshape(count, 4, 2)
    return np.diff(marks, axis=1)


def _row(name: str, took: npt.NDArray[np.float64]) -> tuple[str, ...]:
    return name, *spread(took[:, 0].tolist(), 1e3, 2), *spread(took[:, 1].tolist(), 1e3, 2)
