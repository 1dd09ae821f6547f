"""The table of `value_iteration`, computed once and kept beside the compiled kernels.

Its folder is named by a digest of all sources that it depends on, so no stale table is read.
Imported late: it compiles kernels.
"""

from __future__ import annotations

import hashlib
import os
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

import numpy as np

from missionkit.ground_robot import GroundRobot
from missionkit.kernel_cache import folder_for
from missionkit.planning.herding.value_iteration import Table, values

CELLS = 41
HEADINGS = 40


@lru_cache(maxsize=8)
def value_table(
    length: float, half: float, prices: tuple[float, float], robot: GroundRobot
) -> Table:
    """Return V, (steps + 1, headings, cells, cells), float32; computed in seconds the first time.

    Args:
        length: s, the longest time that it serves.
        half: m, of the arena's side.
        prices: of a bump and of a touch; infinite: not done.
        robot: how it drives.
    """
    steps = int(np.ceil(length / robot.turn_every))
    folder = folder_for(__name__)
    if folder is None:
        return values(steps, CELLS, HEADINGS, half, prices, robot)
    named = hashlib.sha256(repr((steps, half, prices, robot)).encode()).hexdigest()[:16]
    path = folder / f"{named}.npy"
    with suppress(OSError, ValueError, EOFError):
        return _read(path, steps)
    table = values(steps, CELLS, HEADINGS, half, prices, robot)
    with suppress(OSError):
        _write(path, table)
    return table


def _read(path: Path, steps: int) -> Table:
    table: Table = np.load(path, allow_pickle=False)
    if table.shape != (steps + 1, HEADINGS, CELLS, CELLS) or table.dtype != np.float32:
        raise ValueError(f"{path} holds another table")
    return table


def _write(path: Path, table: Table) -> None:
    """Write a table whole or not at all: another process may read it meanwhile."""
    part = path.with_name(f"{path.name}.{os.getpid()}")
    try:
        with part.open("wb") as file:
            np.save(file, table, allow_pickle=False)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
