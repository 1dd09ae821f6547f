"""The runs that have ended: a journal that survives kill -9, and the table made of it.

`rows.jsonl` gets one line when a run ends and is on the disk before the next is counted; a line
that was cut short is dropped when it is read. `runs.csv` is written from it, in order of the runs.
"""

from __future__ import annotations

import csv
import fcntl
import io
import json
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from pydantic import ValidationError

from missionkit.campaigns.run_row import Row
from missionkit.errors import UsageError, printable
from missionkit.recorder.run_folder import write_whole

FORMULA = frozenset("=+-@")  # a text that begins so is calculated
MET = {True: "met", False: "not met", None: ""}
JOURNAL_FILE, TABLE_FILE = "rows.jsonl", "runs.csv"


class Journal:
    """Appends rows to the journal in a folder.

    Raises:
        UsageError: another process does so.
    """

    def __init__(self, folder: Path) -> None:
        path = folder / JOURNAL_FILE
        self._stream = path.open("ab")
        try:
            fcntl.flock(self._stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            self._stream.close()
            raise UsageError(
                f"{folder}: another process is already flying this campaign"
            ) from error
        self._stream.truncate(_whole(path))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stream.close()

    def add(self, row: Row) -> None:
        """Write a row; it is on the disk when this returns."""
        self._stream.write(row.model_dump_json().encode() + b"\n")
        self._stream.flush()
        os.fsync(self._stream.fileno())


def _whole(path: Path) -> int:
    """Return the length of the part that ends with a line's end."""
    return path.read_bytes().rfind(b"\n") + 1 if path.exists() else 0


def read(folder: Path) -> list[Row]:
    """Return the rows of a campaign in order of their runs, each run once.

    Raises:
        UsageError: a line of the journal is none of ours.
    """
    path = folder / JOURNAL_FILE
    if not path.exists():
        return []
    lines = path.read_bytes()[: _whole(path)].splitlines()
    rows: dict[int, Row] = {}
    for number, line in enumerate(lines, 1):
        try:
            row = Row.model_validate_json(line)
        except ValidationError as error:
            raise UsageError(f"{path}:{number}: not a campaign row: {error}") from error
        rows.setdefault(row.number, row)
    return [rows[number] for number in sorted(rows)]


def write(folder: Path, rows: Sequence[Row]) -> Path:
    """Write `runs.csv`, whole or not at all, and return its path."""
    text = io.StringIO()
    table = csv.DictWriter(text, columns(rows), lineterminator="\n")
    table.writeheader()
    table.writerows({key: _harmless(it) for key, it in _cells(row).items()} for row in rows)
    write_whole(folder / TABLE_FILE, text.getvalue())
    return folder / TABLE_FILE


def columns(rows: Iterable[Row]) -> list[str]:
    """Return the columns of a table: fixed ones, then those that some run has."""
    head = dict.fromkeys(("run", "variant", "seed"))
    tail = dict.fromkeys(("outcome", "reason", "path", "problems"))
    seen: dict[str, None] = {}
    for row in rows:
        seen |= dict.fromkeys(_cells(row))
    order = ("param:", "condition:", "metric:", "time:", "count:")
    named = sorted(seen.keys() - head.keys() - tail.keys())
    return [*head, *tail, *(name for first in order for name in named if name.startswith(first))]


def _cells(row: Row) -> dict[str, Any]:
    parameters = row.parameters or row.settings
    return {
        "run": row.number,
        "variant": row.variant,
        "seed": row.seed,
        "outcome": row.outcome,
        "reason": row.reason,
        "path": " > ".join(state for state, _ in row.visits),
        "problems": "; ".join(row.problems),
        **{f"param:{name}": _plain(value) for name, value in parameters.items()},
        **{f"condition:{name}": MET[met] for name, met in row.conditions.items()},
        **{f"metric:{name}": value for name, value in row.metrics.items()},
        **{f"time:{name}": value for name, value in row.times.items()},
        **{f"count:{name}": value for name, value in row.transitions.items()},
    }


def _harmless(value: Any) -> Any:
    """Return a cell of one line that no spreadsheet takes for a formula: it gets an apostrophe."""
    if not isinstance(value, str):
        return value
    line = printable(value)
    return f"'{line}" if value.lstrip()[:1] in FORMULA else line


def _plain(value: Any) -> Any:
    return json.dumps(value) if isinstance(value, list | dict | tuple) else value
