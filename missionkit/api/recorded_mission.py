"""The mission of a recorded flight, as it was flown: its files come out of the journal."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from missionkit.api.missions import LoadedMission, load
from missionkit.api.run_origin import Origin, plugin_changes, plugins_named, text_of
from missionkit.errors import FileError, Problem, UsageError
from missionkit.recorder import value_codec
from missionkit.recorder.journal_reader import Journal

BINARY = re.compile(r"\d+ bytes, SHA-256 [0-9a-f]{64}")  # stands for a file that is no text


def mission_flown(
    journal: Journal,
    folder: Path,
    plugins: Sequence[Path] = (),
    settings: Mapping[str, object] | None = None,
) -> LoadedMission:
    """Return the mission of a journal.

    Args:
        journal: of a flight.
        folder: empty; the mission's files are written there.
        plugins: files that the flight used. A journal may come from anywhere: what it holds is
            read, never run, so they must be named.
        settings: replace those of the flight.

    Raises:
        FileError: the mission cannot be used by this version of missionkit.
        UsageError: a file is missing, or is not the one that was flown.
    """
    origin = origin_of(journal)
    check_plugins(journal.path, origin, plugins)
    path = restored(journal.path, origin, folder)
    flown = dict(text.split("=", 1) for text in origin.settings)
    try:
        return load(path, settings={**flown, **(settings or {})}, plugins=plugins)
    except FileError as error:
        problems = (_in_journal(it, path, folder, journal.path) for it in error.problems)
        raise FileError(problems) from error


def _in_journal(problem: Problem, mission: Path, folder: Path, journal: Path) -> Problem:
    """Return a problem whose place names the journal instead of the file it was written to."""
    if not Path(problem.place.file).is_relative_to(folder):  # a plug-in's
        return problem
    name = os.path.relpath(problem.place.file, mission.parent)
    return replace(problem, place=replace(problem.place, file=f"{journal}: {name}"))


def origin_of(journal: Journal) -> Origin:
    """Return what the flight stood on.

    Raises:
        UsageError: the journal was changed.
    """
    origin = journal.head.origin
    if not isinstance(origin, Origin):
        raise UsageError(f"{journal.path}: it does not describe a mission")
    return origin


def basis_of(journal: Journal) -> str:
    """Return a digest of the files and parameters that a flight stands on.

    Raises:
        UsageError: the journal was changed.
    """
    it = origin_of(journal)
    text = value_codec.written((it.mission, it.settings, it.plugins, it.texts))
    return hashlib.sha256(text.encode()).hexdigest()


def check_plugins(path: Path, origin: Origin, plugins: Sequence[Path]) -> None:
    """Refuse plug-in files that were not named, or that are not those of the flight.

    Args:
        path: of the journal, for messages.
        origin: what the flight stood on.
        plugins: as named now.

    Raises:
        UsageError: one is missing, or differs.
    """
    if origin.plugins and not plugins:
        raise UsageError(
            f"{path}: this flight used plug-in files, which are not run by themselves; "
            f"review them and name them: {plugins_named(origin)}"
        )
    if lines := plugin_changes(origin, plugins):
        raise UsageError("\n".join([f"{path}: a plug-in differs from the one flown", *lines]))


def restored(journal: Path, origin: Origin, folder: Path) -> Path:
    """Write the files of a flight, and return the path of its mission.

    Args:
        journal: for messages.
        origin: what the flight stood on.
        folder: where; nothing is written outside it.

    Raises:
        UsageError: a file that is no text has changed since the flight, or is gone.
    """
    plugins = {os.path.relpath(it, Path(origin.mission).parent) for it in origin.plugins}
    names = [name for name in origin.texts if name not in plugins]
    depth = max((Path(name).parts.count("..") for name in names), default=0)
    root = folder.joinpath(*["root"] * (depth + 1))
    for name in names:
        place = Path(os.path.normpath(root / name))
        if not place.is_relative_to(folder):
            raise UsageError(f"{journal}: it names a file outside its mission's folder: {name}")
        place.parent.mkdir(parents=True, exist_ok=True)
        text = origin.texts[name]
        if BINARY.fullmatch(text):
            _copied(journal, Path(origin.mission).parent / name, text, place)
        else:
            place.write_text(text, encoding="utf-8", newline="")
    return root / Path(origin.mission).name


def _copied(journal: Path, source: Path, text: str, place: Path) -> None:
    if not source.is_file() or text_of(source) != text:
        why = "has changed since" if source.is_file() else "is not there any more"
        raise UsageError(f"{journal}: {source}, which the flight stood on, {why}")
    shutil.copyfile(source, place)
