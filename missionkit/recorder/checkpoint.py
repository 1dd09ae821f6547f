"""Checkpoints of a flight under way: files in the run's folder from which it can go on.

Each is written whole, beside the last one, which is kept: whenever the process dies, at least one
of the two can be read. What only grows (the track) is not written again each time but appended to
journals, and a checkpoint says how many rows of them it stands on. Only the checkpoint waits for
the disk: rows that a power failure took are missed on reading, as if the checkpoint were damaged.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from missionkit.errors import UsageError
from missionkit.recorder import codec
from missionkit.recorder.codec import NotReadableError

HEADER = "missionkit checkpoint 1"
NAME = re.compile("[a-z]+")  # of a journal
NEWEST, BEFORE = "checkpoint.json", "checkpoint-before.json"

Rows = npt.NDArray[np.float64]  # (N, width)
Journal = Callable[[int], Rows]  # from a row on, all that there are


class Saved(NamedTuple):
    """What a checkpoint file holds."""

    value: Any
    counts: Mapping[str, tuple[int, int]]  # journal -> rows, width


class Loaded(NamedTuple):
    """What can be gone on from."""

    value: Any
    journals: Mapping[str, Rows]
    name: str  # of the file
    wrong: tuple[str, ...]  # what is wrong with a newer one


def sealed(value: Any) -> str:
    """Return a value as the text of a file that shows when it was cut short or changed."""
    body = codec.written(value)
    return f"{HEADER} sha256 {_digest(body)}\n{body}\n"


def opened(text: str) -> Any:
    """Return the value that `sealed` was given.

    Raises:
        NotReadableError: the text is not whole, or never was one.
    """
    header, _, body = text.partition("\n")
    body = body.removesuffix("\n")
    if not header.startswith(HEADER):
        raise NotReadableError("this is not a checkpoint of this missionkit")
    if header != f"{HEADER} sha256 {_digest(body)}":
        raise NotReadableError("it was cut short or changed")
    return codec.read(body)


def write_surely(path: Path, text: str) -> None:
    """Write a text file so that, even if the power fails, a reader sees all of it or none."""
    part = path.with_name(f".{path.name}.part")
    with part.open("w", encoding="utf-8") as stream:
        stream.write(text)
        stream.flush()
        os.fsync(stream.fileno())
    os.replace(part, path)  # noqa: PTH105


class Checkpoints:
    """Writes checkpoints into the folder of a run.

    Args:
        folder: exists.
        since: what the flight goes on from, `None` at its start.
    """

    def __init__(self, folder: Path, since: Loaded | None = None) -> None:
        self._folder = folder
        self._counts: dict[str, int] = {}
        if since is not None:
            self._go_on(since)

    def save(self, value: Any, journals: Mapping[str, Journal]) -> None:
        """Write one checkpoint.

        Args:
            value: what `codec.written` can write.
            journals: by name; only rows that are new since the last checkpoint are written.
        """
        shapes = {name: self._appended(name, journal) for name, journal in journals.items()}
        text = sealed(Saved(value, shapes))
        newest = self._folder / NEWEST
        if newest.exists():
            os.replace(newest, self._folder / BEFORE)  # noqa: PTH105
        write_surely(newest, text)

    def forget(self) -> None:
        """Remove all of it: the flight has ended."""
        for path in (self._folder / NEWEST, self._folder / BEFORE):
            path.unlink(missing_ok=True)
        for name in self._counts:
            _journal(self._folder, name).unlink(missing_ok=True)

    def _go_on(self, since: Loaded) -> None:
        """Drop what is newer than the checkpoint that is gone on from."""
        if since.name == BEFORE:
            os.replace(self._folder / BEFORE, self._folder / NEWEST)  # noqa: PTH105
        for name, rows in since.journals.items():
            os.truncate(_journal(self._folder, name), rows.nbytes)
            self._counts[name] = len(rows)

    def _appended(self, name: str, journal: Journal) -> tuple[int, int]:
        """Write what is new; return how many rows there are now, and how wide they are."""
        before = self._counts.get(name, 0)
        fresh = journal(before)
        with _journal(self._folder, name).open("ab") as stream:
            stream.write(fresh.astype("<f8").tobytes())
        self._counts[name] = before + len(fresh)
        return self._counts[name], fresh.shape[1]


def load(folder: Path) -> Loaded:
    """Return what the newest checkpoint that can be read holds.

    Raises:
        UsageError: there is none; says what is wrong with each.
    """
    wrong: list[str] = []
    for name in (NEWEST, BEFORE):
        path = folder / name
        try:
            saved = opened(path.read_text(encoding="utf-8"))
            journals = {name: _rows(folder, name, *shape) for name, shape in saved.counts.items()}
        except FileNotFoundError as error:
            if error.filename != str(path):
                wrong.append(f"{error.filename}: no such file, though {name} needs it")
        except (OSError, ValueError, TypeError, AttributeError, NotReadableError) as error:
            wrong.append(f"{path}: this checkpoint cannot be used: {error}")
        else:
            return Loaded(saved.value, journals, name, tuple(wrong))
    raise UsageError("\n".join(wrong) or f"{folder}: nothing to resume: it holds no checkpoint")


def _rows(folder: Path, name: str, count: int, width: int) -> Rows:
    """Return the first rows of a journal; what was appended after the checkpoint does not count."""
    size = np.dtype("<f8").itemsize * count * width
    with _journal(folder, name).open("rb") as stream:
        flat = np.frombuffer(stream.read(size), "<f8")
    return flat.reshape(count, width).astype(np.float64)


def _journal(folder: Path, name: str) -> Path:
    if not NAME.fullmatch(name):
        raise NotReadableError(f"a journal {name!r}")
    return folder / f"checkpoint-{name}.rows"


def _digest(body: str) -> str:
    return hashlib.sha256(body.encode()).hexdigest()
