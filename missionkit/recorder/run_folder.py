"""The folder of a run: `runs/<mission>-<label>`, never written over."""

from __future__ import annotations

import fcntl
import itertools
import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from missionkit.errors import UsageError


def run_folder(root: Path, mission: str, label: str) -> Path:
    """Create and return an empty folder for one run.

    Args:
        root: where runs are kept; created when missing.
        mission: name of the mission; characters unfit for a file name become `-`.
        label: what tells runs apart, such as the seed or a time stamp.

    Returns:
        `root/mission-label`, or with `-2`, `-3`, … behind it when that is taken.
    """
    root.mkdir(parents=True, exist_ok=True)
    name = re.sub(r"[^\w.=+-]+", "-", f"{mission}-{label}").strip("-.") or "run"
    for attempt in itertools.count(1):
        folder = root / (name if attempt == 1 else f"{name}-{attempt}")
        try:
            folder.mkdir()
        except FileExistsError:
            continue
        return folder
    raise AssertionError  # count never ends


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Keep other processes from flying the run in a folder while this context is open.

    The kernel lets go of it when the process ends, however. Some network file systems know no
    locks: there nothing is held.

    Raises:
        UsageError: another process flies it.
    """
    number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        try:
            fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            why = "another missionkit is flying this run; wait for it, or stop it first"
            raise UsageError(f"{folder}: {why}") from None
        except OSError:  # no locks here
            pass
        yield
    finally:
        os.close(number)


def keep_mission(folder: Path, mission: Path) -> Path:
    """Copy the mission file that is flown into the run's folder; return the copy."""
    return Path(shutil.copyfile(mission, folder / free_name(folder, "mission.yaml")))


def free_name(folder: Path, name: str) -> str:
    """Return `flight.mcap`, or `flight-2.mcap`, … when that is taken."""
    stem, dot, ending = name.partition(".")
    numbered = (f"{stem}-{number}{dot}{ending}" for number in itertools.count(2))
    return next(it for it in itertools.chain([name], numbered) if not (folder / it).exists())


def write_whole(path: Path, text: str) -> None:
    """Write a text file so that a reader sees all of it or none."""
    part = path.with_name(f".{path.name}.part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, path)  # noqa: PTH105
