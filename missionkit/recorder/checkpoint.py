"""Checkpoints of a flight in progress: files in the run's folder from which it can resume.

Each is written whole, beside the last one, which is kept: whenever the process dies, at least one
of the two can be read. What only grows (the track) is not written again each time but appended to
journals, and a checkpoint says how many rows of them it stands on, and their SHA-256: nothing is
used that was not checked. Only the checkpoint waits for the disk: rows that a power failure took
are missed on reading, as if the checkpoint were damaged.
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

from missionkit.chart.text.regular_file import read_bytes
from missionkit.errors import UsageError
from missionkit.recorder import value_codec
from missionkit.recorder.value_codec import NotReadableError

CHECKPOINT_PREFIX = "missionkit checkpoint "
HEADER = f"{CHECKPOINT_PREFIX}7"  # the version grows when a saved type is renamed, moved or changed
JOURNAL_NAME = re.compile("[a-z]+")  # of a journal
NEWEST, BEFORE_NEWEST = "checkpoint.json", "checkpoint-before.json"

Rows = npt.NDArray[np.float64]  # (N, width)
Journal = Callable[[int], Rows]  # from a row on, all that there are


class Stretch(NamedTuple):
    """The rows of a journal that a checkpoint stands on."""

    rows: int
    width: int
    digest: str  # SHA-256 of their bytes


class Saved(NamedTuple):
    """Content of a checkpoint file."""

    value: Any
    journals: Mapping[str, Stretch]


class Loaded(NamedTuple):
    """A checkpoint that was read, with its journals."""

    value: Any
    journals: Mapping[str, Rows]
    name: str  # of the file
    wrong: tuple[str, ...]  # what is wrong with a newer one


def sealed(value: Any) -> str:
    """Return a value as the text of a file that shows when it was truncated or changed."""
    body = value_codec.written(value)
    return f"{HEADER} sha256 {_digest(body)}\n{body}\n"


def opened(text: str) -> Any:
    """Return the value that `sealed` was given.

    Raises:
        NotReadableError: the text is not whole, or never was one.
    """
    header, _, body = text.partition("\n")
    body = body.removesuffix("\n")
    if header.startswith(CHECKPOINT_PREFIX) and not header.startswith(f"{HEADER} "):
        raise NotReadableError(f"another version of missionkit wrote it; this one reads '{HEADER}'")
    if not header.startswith(HEADER):
        raise NotReadableError("this is not a checkpoint of this missionkit")
    if header != f"{HEADER} sha256 {_digest(body)}":
        raise NotReadableError("it was truncated or changed")
    return value_codec.read(body)


def write_surely(path: Path, text: str, before: Path | None = None) -> None:
    """Write a text file so that, even if the power fails, a reader sees all of it or none.

    Args:
        path: where.
        text: what.
        before: where the file goes that is there already; `None`: it is replaced.
    """
    part = path.with_name(f".{path.name}.part")
    with part.open("w", encoding="utf-8") as stream:
        stream.write(text)
        stream.flush()
        os.fsync(stream.fileno())
    if before is not None and path.exists():
        os.replace(path, before)  # noqa: PTH105
    os.replace(part, path)  # noqa: PTH105


class _Written(NamedTuple):
    """The part of a journal that is on disk."""

    rows: int
    size: int  # bytes
    sum: hashlib._Hash  # of them


class Checkpoints:
    """Writes checkpoints into the folder of a run.

    Args:
        folder: exists.
        since: what the flight resumes from, `None` at its start.
    """

    def __init__(self, folder: Path, since: Loaded | None = None) -> None:
        self._folder = folder
        self._written: dict[str, _Written] = {}
        if since is not None:
            self._go_on(since)

    def save(self, value: Any, journals: Mapping[str, Journal]) -> None:
        """Write one checkpoint.

        Args:
            value: what `value_codec.written` can write.
            journals: by name; only rows that are new since the last checkpoint are written.
        """
        rows = {name: self._appended(name, journal) for name, journal in journals.items()}
        write_surely(
            self._folder / NEWEST, sealed(Saved(value, rows)), self._folder / BEFORE_NEWEST
        )

    def forget(self) -> None:
        """Remove all of it: the flight has ended."""
        for path in (self._folder / NEWEST, self._folder / BEFORE_NEWEST):
            path.unlink(missing_ok=True)
        for name in self._written:
            _journal(self._folder, name).unlink(missing_ok=True)

    def _go_on(self, since: Loaded) -> None:
        """Drop what is newer than the checkpoint to resume from."""
        if since.name == BEFORE_NEWEST:
            os.replace(self._folder / BEFORE_NEWEST, self._folder / NEWEST)  # noqa: PTH105
        for name, rows in since.journals.items():
            os.truncate(_journal(self._folder, name), rows.nbytes)
            self._written[name] = _Written(len(rows), rows.nbytes, _sum(_bytes(rows)))

    def _appended(self, name: str, journal: Journal) -> Stretch:
        """Write what is new, over what a write that failed has left; return what there is now."""
        before = self._written.get(name) or _Written(0, 0, _sum(b""))
        fresh = journal(before.rows)
        data, path = _bytes(fresh), _journal(self._folder, name)
        with path.open("r+b" if before.rows else "wb") as stream:
            stream.truncate(before.size)
            stream.seek(before.size)
            stream.write(data)
        total = before.sum.copy()
        total.update(data)
        count = before.rows + len(fresh)
        self._written[name] = _Written(count, before.size + len(data), total)
        return Stretch(count, fresh.shape[1], total.hexdigest())


def load(folder: Path) -> Loaded:
    """Return what the newest checkpoint that can be read holds.

    Raises:
        UsageError: there is none; says what is wrong with each.
    """
    wrong: list[str] = []
    for name in (NEWEST, BEFORE_NEWEST):
        path = folder / name
        try:
            saved = opened(read_bytes(path).decode())
            journals = {name: _rows(folder, name, it) for name, it in saved.journals.items()}
        except FileNotFoundError as error:
            if error.filename != str(path):
                wrong.append(f"{error.filename}: no such file, though {name} needs it")
        except (OSError, ValueError, TypeError, AttributeError, NotReadableError) as error:
            wrong.append(f"{path}: this checkpoint cannot be used: {error}")
        else:
            return Loaded(saved.value, journals, name, tuple(wrong))
    raise UsageError("\n".join(wrong) or f"{folder}: nothing to resume: it holds no checkpoint")


def _rows(folder: Path, name: str, stretch: Stretch) -> Rows:
    """Return the first rows of a journal; what was appended after the checkpoint does not count.

    Raises:
        NotReadableError: they are not those that were written.
    """
    path, count, width = _journal(folder, name), stretch.rows, stretch.width
    data = read_bytes(path, np.dtype("<f8").itemsize * count * width)
    if _sum(data).hexdigest() != stretch.digest:
        raise NotReadableError(f"{path.name}, which it builds on, was truncated or changed")
    return np.frombuffer(data, "<f8").reshape(count, width).astype(np.float64)


def _bytes(rows: Rows) -> bytes:
    return rows.astype("<f8").tobytes()


def _sum(data: bytes) -> hashlib._Hash:
    return hashlib.sha256(data)


def _journal(folder: Path, name: str) -> Path:
    if not JOURNAL_NAME.fullmatch(name):
        raise NotReadableError(f"a journal {name!r}")
    return folder / f"checkpoint-{name}.rows"


def _digest(body: str) -> str:
    return _sum(body.encode()).hexdigest()
