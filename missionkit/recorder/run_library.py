"""Runs on disk: what their summaries say, and the tags that people gave them.

A run is a folder with a record, a journal or a summary. Its tags are the lines of `tags.txt` in it.
Whatever is missing or damaged in a run is a sentence about that run; the others are listed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from pydantic import ValidationError

from missionkit.errors import UsageError
from missionkit.recorder.flight_journal import JOURNAL_FILE
from missionkit.recorder.run_folder import write_whole
from missionkit.recorder.run_summary import SUMMARY_FILE, Summary

TAGS_FILE, ORIGIN_FILE = "tags.txt", "origin.json"
MARKS = (SUMMARY_FILE, "flight.mcap", JOURNAL_FILE, ORIGIN_FILE)  # one of them makes a run
DEPTH = 3  # folders inside folders: a fleet's runs are two deep
MOST_BYTES = 16 << 20  # of a summary
TAG = re.compile(r"\w[\w.-]{0,63}")


class ListedRun(NamedTuple):
    """One run of a library.

    Attributes:
        folder: of the run.
        tags: that people gave it, in alphabetical order.
        summary: what came of it; None: it has none that can be read.
        problem: what is missing or damaged, a sentence; "": nothing.
    """

    folder: Path
    tags: tuple[str, ...]
    summary: Summary | None
    problem: str = ""

    @property
    def outcome(self) -> str:
        """How it ended: "success", "ended_safely", "crash", or "unknown"."""
        return "unknown" if self.summary is None else self.summary.outcome

    @property
    def words(self) -> str:
        """All that a search looks through, in small letters."""
        parts = [self.folder.name, *self.tags]
        if self.summary is not None:
            it = self.summary
            parts += [it.mission, it.reason, *it.faults, *it.problems]
            parts += [f"{name}={value}" for name, value in it.parameters.items()]
            parts += [stay.state for stay in it.states]
        return "\n".join(parts).lower()


def runs_of(folder: Path) -> list[ListedRun]:
    """Return the runs in a folder, or the one that it is, by name.

    Raises:
        UsageError: there is no such folder.
    """
    if not folder.is_dir():
        raise UsageError(f"{folder}: no such folder")
    return [listed(it) for it in sorted(_runs(folder, DEPTH))]


def listed(run: Path) -> ListedRun:
    """Return what is known of the run in a folder."""
    summary: Summary | None = None
    problems: list[str] = []
    try:
        summary = _summary(run)
    except UsageError as error:
        problems.append(str(error))
    try:
        tags = tags_of(run)
    except UsageError as error:
        tags = ()
        problems.append(str(error))
    return ListedRun(run, tags, summary, "; ".join(problems))


def tags_of(run: Path) -> tuple[str, ...]:
    """Return the tags of a run, in alphabetical order.

    Raises:
        UsageError: they cannot be read.
    """
    path = run / TAGS_FILE
    if not path.exists():
        return ()
    lines = _text(path, 1 << 16).split()
    return tuple(sorted({it for it in lines if TAG.fullmatch(it)}))


def tag(run: Path, add: Iterable[str] = (), remove: Iterable[str] = ()) -> tuple[str, ...]:
    """Add and remove tags of a run, and return those it has then.

    Args:
        run: its folder.
        add: names of letters, digits, `.`, `_` and `-`.
        remove: names; one that it does not have is no mistake.

    Raises:
        UsageError: a name cannot be a tag, or the tags cannot be read or written.
    """
    add = tuple(add)
    for name in add:
        if not TAG.fullmatch(name):
            raise UsageError(f"tag {name!r}: expected up to 64 letters, digits, '.', '_' or '-'")
    tags = sorted(({*tags_of(run), *add}) - set(remove))
    try:
        if tags:
            write_whole(run / TAGS_FILE, "".join(f"{it}\n" for it in tags))
        else:
            (run / TAGS_FILE).unlink(missing_ok=True)
    except OSError as error:
        raise UsageError(f"{run / TAGS_FILE}: cannot be written: {error.strerror}") from error
    return tuple(tags)


def _runs(folder: Path, depth: int) -> Iterator[Path]:
    if any((folder / name).is_file() for name in MARKS):
        yield folder
        return
    if depth:
        try:
            inside = [it for it in folder.iterdir() if it.is_dir() and not it.is_symlink()]
        except OSError:  # not ours to read
            return
        for each in inside:
            yield from _runs(each, depth - 1)


def _summary(run: Path) -> Summary:
    path = run / SUMMARY_FILE
    if not path.is_file():
        unfinished = (run / ORIGIN_FILE).is_file()
        why = "it is still flying, or can be resumed" if unfinished else "the flight was killed"
        raise UsageError(f"no {SUMMARY_FILE}: {why}")
    try:
        return Summary.model_validate_json(_text(path, MOST_BYTES))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        says = f"{where}: {first['msg']}" if where else first["msg"]
        raise UsageError(f"{SUMMARY_FILE} cannot be read: {says}") from error


def _text(path: Path, most: int) -> str:
    try:
        with path.open("rb") as stream:
            data = stream.read(most + 1)
    except OSError as error:
        raise UsageError(f"{path.name} cannot be read: {error.strerror}") from error
    if len(data) > most:
        raise UsageError(f"{path.name} cannot be read: it is larger than {most} bytes")
    try:
        return data.decode()
    except UnicodeDecodeError as error:
        raise UsageError(f"{path.name} cannot be read: not UTF-8 text") from error
