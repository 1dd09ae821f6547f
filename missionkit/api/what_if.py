"""What another mission would have decided in flights that were recorded."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

from missionkit.api.missions import NO_SETTINGS, LoadedMission, load
from missionkit.api.recorded_mission import basis_of, mission_flown, origin_of
from missionkit.api.replay import journal_from_start, journals
from missionkit.chart.model.guard_expressions import Use
from missionkit.chart.model.mission import Mission
from missionkit.engine.prepared_mission import PreparedMission, prepare
from missionkit.errors import FileError, MissionkitError, UsageError
from missionkit.recorder.journal_reader import Journal
from missionkit.replays.decision_table import DecisionTable, compared
from missionkit.replays.replayed_flight import replayed

SENSING = ("perception", "camera", "navigation", "targets", "known", "tracking")
WORTH_A_PROCESS = 4  # flights; starting one takes a second


class Question(NamedTuple):
    """What is asked of each flight.

    Attributes:
        mission: file of the other mission; None: the one that was flown.
        settings: values of parameters that differ from those of the flight.
        plugins: plug-in files that the mission uses.
    """

    mission: Path | None
    settings: Mapping[str, object] = {}
    plugins: tuple[Path, ...] = ()


def question_of(
    mission: str | Path | None, settings: Mapping[str, object], plugins: Sequence[str | Path]
) -> Question:
    """Return a question as a user asks it.

    Args:
        mission: file of the other mission; None: the one that was flown.
        settings: values of parameters that differ.
        plugins: plug-in files.
    """
    other = None if mission is None else Path(mission)
    return Question(other, settings, tuple(map(Path, plugins)))


class PreparedAnswer(NamedTuple):
    """A mission prepared for the flights that stand on the same files and parameters."""

    plan: PreparedMission
    notes: tuple[str, ...]


Prepared = dict[str, PreparedAnswer]  # by what a flight stands on


class WhatIf(NamedTuple):
    """What another mission would have decided in one flight.

    Attributes:
        journal: file of the flight.
        table: its transitions, in flight and now.
        notes: sentences: what of the comparison does not hold.
    """

    journal: Path
    table: DecisionTable
    notes: tuple[str, ...]


def what_if(
    run: str | Path,
    mission: str | Path | None = None,
    *,
    settings: Mapping[str, object] = NO_SETTINGS,
    plugins: Sequence[str | Path] = (),
) -> WhatIf:
    """Fly what was recorded through another mission, and compare the transitions.

    The observations stay those of the flight. Up to the first command that differs that is exact;
    later transitions are marked, for the vehicle would have been elsewhere.

    Args:
        run: folder of a run, or a journal. Of a resumed flight the first part counts.
        mission: file of the other mission; the one that was flown if absent.
        settings: values of parameters that differ from those of the flight.
        plugins: plug-in files that the mission uses.

    Raises:
        FileError: the mission has errors.
        UsageError: there is no journal, or it cannot be read.

    Example:
        >>> summary = missionkit.rehearse(mission, folder="runs/slow")
        >>> found = missionkit.what_if("runs/slow", settings={"cruise": 8})
        >>> found.table.first is None, found.table.parted is None
        (True, False)
    """
    return _answer(question_of(mission, settings, plugins), Path(run), {})


def what_if_each(
    runs: Sequence[Path], question: Question, *, processes: int = 1
) -> list[WhatIf | MissionkitError]:
    """Return the answer for each of many flights, or why there is none, in the order of the runs.

    Args:
        runs: folders of runs, or journals.
        question: what is asked of each.
        processes: that share the work; a mission is prepared once in each.
    """
    if processes == 1 or len(runs) < WORTH_A_PROCESS:
        return _answers(question, runs)
    parts = [runs[n::processes] for n in range(processes)]
    plain = question._replace(settings=dict(question.settings))
    with ProcessPoolExecutor(processes, get_context("spawn")) as pool:
        answers = list(pool.map(_answers, [plain] * processes, parts))
    return [answers[n % processes][n // processes] for n in range(len(runs))]


def without_copies(runs: Sequence[Path]) -> tuple[list[Path], list[str]]:
    """Return runs whose flights are all different, and a sentence for each copy left out.

    Args:
        runs: folders of runs, or journals.
    """
    first: dict[str, Path] = {}
    notes: list[str] = []
    for run in runs:
        digest = _digest(journals(run)[0])
        if digest in first:
            notes.append(f"{run}: the same flight as {first[digest]}: counted once")
        else:
            first[digest] = run
    return list(first.values()), notes


def _digest(path: Path) -> str:
    try:
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError:  # reading it says why
        return str(path.resolve())


def _answers(question: Question, runs: Sequence[Path]) -> list[WhatIf | MissionkitError]:
    prepared: Prepared = {}
    found: list[WhatIf | MissionkitError] = []
    for run in runs:
        try:
            found.append(_answer(question, run, prepared))
        except FileError as error:
            found.append(FileError(error.problems))
        except UsageError as error:
            found.append(UsageError(str(error)))
    return found


def _answer(question: Question, run: Path, prepared: Prepared) -> WhatIf:
    journal = journal_from_start(run)
    plan, notes = _prepared(question, journal, prepared)
    table = compared(replayed(plan, journal))
    return WhatIf(journal.path, table, (*([journal.ends] if journal.ends else []), *notes))


def _prepared(question: Question, journal: Journal, prepared: Prepared) -> PreparedAnswer:
    """Return the mission that decides; flights that stand on the same share one."""
    key = basis_of(journal)
    if key not in prepared:
        with tempfile.TemporaryDirectory() as folder:
            prepared[key] = _prepare(question, journal, Path(folder))
    return prepared[key]


def _prepare(question: Question, journal: Journal, folder: Path) -> PreparedAnswer:
    mission = mission_asked(question, journal, folder)
    plan = prepare(mission.model, mission.catalogue)
    if question.mission is None:
        return PreparedAnswer(plan, ())
    return PreparedAnswer(plan, tuple(_notes(journal, folder, mission, question.plugins)))


def mission_asked(question: Question, journal: Journal, folder: Path) -> LoadedMission:
    """Return the mission that a flight is asked with.

    Args:
        question: what is asked.
        journal: of the flight.
        folder: empty; the files of the flight are written there, if it is its own mission.

    Raises:
        FileError: the mission has errors.
        UsageError: values that come from the flight do not fit it.
    """
    path, settings, files = question
    if path is None:
        return mission_flown(journal, folder, files, settings)
    return _other(journal, path, settings, files)


def _other(
    journal: Journal, path: Path, settings: Mapping[str, object], plugins: Sequence[Path]
) -> LoadedMission:
    """Return another mission, with the flight's values of the parameters that it has too."""
    plain = load(path, plugins=plugins)
    flown = dict(text.split("=", 1) for text in origin_of(journal).settings)
    kept = {
        name: value
        for name, value in flown.items()
        if name in plain.parameters and name not in settings
    }
    try:
        return load(path, settings={**kept, **settings}, plugins=plugins)
    except FileError as error:
        if not kept:
            raise
        values = ", ".join(
            f"{name} = {value} (the file: {plain.parameters[name]})" for name, value in kept.items()
        )
        raise UsageError(
            f"{journal.path}: {path} has errors with values that come from this flight, not from "
            f"the file: {values}; --set replaces them\n{error}"
        ) from error


def _notes(
    journal: Journal, folder: Path, other: LoadedMission, plugins: Sequence[Path]
) -> Iterator[str]:
    """Yield what of the sensing differs: the detections are those of the flight."""
    flown = mission_flown(journal, folder, plugins)
    differs = [name for name in SENSING if _differs(flown.model, other.model, name)]
    if differs:
        yield (
            f"{other.path}: {', '.join(differs)} differs from what flew: what the camera showed is "
            "as detected in flight"
        )


def _differs(one: Mission, other: Mission, name: str) -> bool:
    return bool(plain_section(getattr(one, name)) != plain_section(getattr(other, name)))


def plain_section(value: object) -> object:
    """Return a section of a mission without where in its file it stands."""
    if isinstance(value, Use):
        return value.kind, value.plugin
    return tuple(map(plain_section, value)) if isinstance(value, tuple) else value
