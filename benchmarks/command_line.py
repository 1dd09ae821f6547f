"""How long the command line takes to answer."""

from __future__ import annotations

import resource
import subprocess
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from statistics import median

from benchmarks.flights import MISSION
from benchmarks.measure import Table, Took, timed

REPEATS = 10
MISSIONKIT = str(Path(sys.executable).with_name("missionkit"))
COMMANDS = {
    "python -c pass": [sys.executable, "-c", "pass"],
    "python -c 'import numpy, pydantic'": [sys.executable, "-c", "import numpy, pydantic"],
    "missionkit --help": [MISSIONKIT, "--help"],
    f"missionkit validate {MISSION}": [MISSIONKIT, "validate", str(MISSION)],
}
ALLOWED = ("", "", "150", "400")  # ms


def tables() -> list[Table]:
    """Time whole processes, in turns so that all see the same machine."""
    times: dict[str, list[Took]] = {name: [] for name in COMMANDS}
    for turn in range(REPEATS + 1):
        for name, command in COMMANDS.items():
            took = _run(command)
            times[name] += [took] if turn else []  # the first turn warms the caches
    bare = median(it.cpu for it in times["python -c pass"])
    rows = [
        (
            name,
            _fastest(it.wall for it in took),
            _median(it.wall for it in took),
            limit,
            _median(it.cpu for it in took),
            _ratio(took, bare),
        )
        for (name, took), limit in zip(times.items(), ALLOWED, strict=True)
    ]
    header = (
        *("command", "fastest, ms", "median, ms", "allowed, ms", "processor, ms"),
        "x bare python, processor",
    )
    note = f"{REPEATS} runs each, in turns, after a warm-up. Processor time is the median."
    return [Table("Command line", header, rows, note)]


def _run(command: Sequence[str]) -> Took:
    """Run a process; return its time on the wall and on the processor."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    _, took = timed(subprocess.run, command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return Took(took.wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def _fastest(times: Iterable[float]) -> str:
    return f"{1e3 * min(times):.0f}"


def _median(times: Iterable[float]) -> str:
    return f"{1e3 * median(times):.0f}"


def _ratio(took: Sequence[Took], bare: float) -> str:
    return f"{median(it.cpu for it in took) / bare:.1f}"
