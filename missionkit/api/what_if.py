"""What another mission would have decided in a flight that was recorded."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from missionkit.api.missions import NO_SETTINGS, LoadedMission, load
from missionkit.api.recorded_mission import mission_flown, origin_of
from missionkit.api.replay import journals
from missionkit.chart.model.guard_expressions import Use
from missionkit.chart.model.mission import Mission
from missionkit.engine.prepared_mission import prepare
from missionkit.errors import UsageError
from missionkit.recorder.journal_reader import Journal, read_journal
from missionkit.replays.decision_table import DecisionTable, compared
from missionkit.replays.replayed_flight import replayed

SENSING = ("perception", "camera", "navigation", "targets", "known", "tracking")


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
    journal = read_journal(journals(Path(run))[0])
    if not journal.head.begins:
        raise UsageError(f"{journal.path}: this is a resumed part: only its first part can be used")
    files = [Path(it) for it in plugins]
    with tempfile.TemporaryDirectory() as folder:
        flown = None if mission else mission_flown(journal, Path(folder), files, settings)
        other = flown or _other(journal, Path(str(mission)), settings, files)
        plan = prepare(other.model, other.catalogue)
        notes = () if mission is None else tuple(_notes(journal, Path(folder), other, files))
    table = compared(replayed(plan, journal))
    return WhatIf(journal.path, table, (*([journal.ends] if journal.ends else []), *notes))


def _other(
    journal: Journal, path: Path, settings: Mapping[str, object], plugins: Sequence[Path]
) -> LoadedMission:
    """Return another mission, with the flight's values of the parameters that it has too."""
    plain = load(path, plugins=plugins)
    flown = dict(text.split("=", 1) for text in origin_of(journal).settings)
    kept = {name: value for name, value in flown.items() if name in plain.parameters}
    return load(path, settings={**kept, **settings}, plugins=plugins)


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
    return bool(_without_places(getattr(one, name)) != _without_places(getattr(other, name)))


def _without_places(value: object) -> object:
    """Return a section of a mission without where in its file it stands."""
    if isinstance(value, Use):
        return value.kind, value.plugin
    return tuple(map(_without_places, value)) if isinstance(value, tuple) else value
