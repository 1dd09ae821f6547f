"""Replaying flights: every tick is computed again and compared with what was flown."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from missionkit.api.recorded_mission import basis_of, mission_flown
from missionkit.engine.prepared_mission import PreparedMission, prepare
from missionkit.errors import UsageError
from missionkit.recorder.flight_journal import JOURNAL_FILE
from missionkit.recorder.journal_reader import Journal, read_journal
from missionkit.replays.decision_difference import first_difference
from missionkit.replays.replayed_flight import replayed, start_at
from missionkit.version import __version__

PART = re.compile(rf"{Path(JOURNAL_FILE).stem}-\d+")  # of a resumed flight; not a copy of one


class ReplayDifference(NamedTuple):
    """First tick that decides otherwise than in flight."""

    at: float  # s, mission time
    tick: int
    field: str  # which field, with both values


class Replay(NamedTuple):
    """Result of a replay.

    Attributes:
        journal: file that was replayed.
        ticks: number of ticks that were computed again.
        since: s, mission time of the first.
        until: s, mission time of the last.
        difference: the first difference, None if there is none.
        notes: sentences: what of the journal cannot be used, which version flew.
    """

    journal: Path
    ticks: int
    since: float
    until: float
    difference: ReplayDifference | None
    notes: tuple[str, ...]


def replay(
    run: str | Path, *, since: float = 0.0, plugins: Sequence[str | Path] = ()
) -> tuple[Replay, ...]:
    """Compute every tick of a recorded flight again, and compare what it decides, bit by bit.

    The mission comes out of the journal, as it was flown. Verdicts, transitions and commands are
    compared; the observations are those of the flight, detections instead of images.

    Args:
        run: folder of a run or of several, such as a fleet's, or a journal.
        since: mission time (s) from which to replay; earlier by up to 5 s, where the journal holds
            a memory to start from.
        plugins: plug-in files that the flight used.

    Returns:
        One result for each journal: a resumed flight has several.

    Raises:
        FileError: the mission cannot be used by this version of missionkit.
        UsageError: there is no journal, it cannot be read, or a plug-in file is not named.

    Example:
        >>> summary = missionkit.rehearse(mission, folder="runs/kept")
        >>> [part.difference for part in missionkit.replay("runs/kept")]
        [None]
    """
    files = [Path(it) for it in plugins]
    paths = [path for it in runs_in([Path(run)]) for path in journals(it)]
    plans: dict[str, PreparedMission] = {}  # flights that stand on the same share one
    return tuple(_replayed(read_journal(path), since, files, plans) for path in paths)


def runs_in(folders: Sequence[Path]) -> list[Path]:
    """Return the runs in folders: each is one, or holds several.

    Raises:
        UsageError: there is none in one of them.
    """
    found: list[Path] = []
    for folder in folders:
        if folder.is_file() or (folder / JOURNAL_FILE).is_file():
            found.append(folder)
            continue
        inside = sorted(it.parent for it in folder.glob(f"*/{JOURNAL_FILE}"))
        if not inside:
            lacks = "neither it nor a folder in it holds a " + JOURNAL_FILE
            raise UsageError(f"{folder}: {lacks if folder.is_dir() else 'no such folder'}")
        found += inside
    return found


def journals(run: Path) -> list[Path]:
    """Return the journals of a run in the order they were flown.

    Raises:
        UsageError: there is none.
    """
    if run.is_file():
        return [run]
    stem, ending = Path(JOURNAL_FILE).stem, Path(JOURNAL_FILE).suffix
    parts = [it for it in run.glob(f"{stem}-*{ending}") if PART.fullmatch(it.stem)]
    parts.sort(key=lambda it: (len(it.name), it.name))
    found = [it for it in (run / JOURNAL_FILE, *parts) if it.is_file()]
    if not found:
        raise UsageError(f"{run}: it holds no {JOURNAL_FILE}")
    return found


def journal_from_start(run: str | Path) -> Journal:
    """Return the first journal of a run, which must begin with the mission.

    Raises:
        UsageError: there is none, it cannot be read, or it is of a resumed part.
    """
    journal = read_journal(journals(Path(run))[0])
    if not journal.head.begins:
        raise UsageError(f"{journal.path}: this is a resumed part: only its first part can be used")
    return journal


def _replayed(
    journal: Journal, since: float, plugins: Sequence[Path], plans: dict[str, PreparedMission]
) -> Replay:
    basis = basis_of(journal)
    if basis not in plans:
        with tempfile.TemporaryDirectory() as folder:
            mission = mission_flown(journal, Path(folder), plugins)
            plans[basis] = prepare(mission.model, mission.catalogue)
    plan = plans[basis]
    if journal.ticks and since > journal.ticks[-1][0]:
        last = journal.ticks[-1][0]
        raise UsageError(
            f"{journal.path}: there is nothing after {since:g} s: it ends at {last:.2f} s"
        )
    start = start_at(plan, journal, since)
    begun, until, count = start.memory.now, start.memory.now, 0
    difference: ReplayDifference | None = None
    for tick in replayed(plan, journal, start):
        until, count = tick.now, count + 1
        field = first_difference(tick.flown, tick.replayed)
        if field:
            difference = ReplayDifference(tick.now, tick.number, field)
            break
    ended = difference is not None or start.number + count == len(journal.ticks)
    notes = tuple(_notes(journal, until, whole=ended))
    return Replay(journal.path, count, begun, until, difference, notes)


def _notes(journal: Journal, until: float, *, whole: bool) -> Iterator[str]:
    if journal.ends:
        yield journal.ends
    if not whole:
        yield f"{journal.path}: ticks are missing after {until:.2f} s: the replay ends there"
    version = journal.head.origin.version
    if version != __version__:
        yield f"{journal.path}: missionkit {version} flew, {__version__} replays"
