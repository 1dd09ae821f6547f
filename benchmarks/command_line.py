"""How long the command line takes to answer."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from statistics import median

from benchmarks.flights import MISSION
from benchmarks.measure import Table, timed

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
    times: dict[str, list[float]] = {name: [] for name in COMMANDS}
    for turn in range(REPEATS + 1):
        for name, command in COMMANDS.items():
            _, took = timed(subprocess.run, command, check=True, stdout=subprocess.DEVNULL)
            times[name] += [took.wall] if turn else []  # the first turn warms the caches
    bare = median(times["python -c pass"])
    rows = [
        (name, f"{1e3 * min(took):.0f}", f"{1e3 * median(took):.0f}", limit, _ratio(took, bare))
        for (name, took), limit in zip(times.items(), ALLOWED, strict=True)
    ]
    header = ("command", "fastest, ms", "median, ms", "allowed, ms", "x bare python")
    return [Table("Command line", header, rows, f"{REPEATS} runs each, in turns, after a warm-up.")]


def _ratio(took: list[float], bare: float) -> str:
    return f"{median(took) / bare:.1f}"
