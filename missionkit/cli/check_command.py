"""`missionkit check`: the requirements of a mission on the record of a flight."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path

from missionkit.api.missions import assemble
from missionkit.chart.load import load
from missionkit.chart.model.mission import Mission
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.chart.semantics.requirement_watch import STANDINGS
from missionkit.cli.overrides import overrides
from missionkit.errors import ExitCode, UsageError, printable
from missionkit.recorder.requirement_check import CheckedRecord, check_record

RECORD_FILE = "flight.mcap"


def check(
    mission: Path,
    record: Path,
    settings: Iterable[str],
    plugins: Iterable[Path],
    *,
    as_json: bool,
) -> ExitCode:
    """Say of each requirement whether a recorded flight fulfilled it.

    Args:
        mission: the file that states the requirements.
        record: `flight.mcap`, or the folder of a run.
        settings: NAME=VALUE, as of `--set`.
        plugins: files with plug-ins.
        as_json: for programs.

    Raises:
        FileError: the mission or a plug-in file cannot be loaded.
        UsageError: the mission has no requirements, or the record cannot be read.
    """
    catalogue = assemble(plugins)
    model = load(mission, catalogue, overrides(settings))
    if not model.requirements:
        raise UsageError(f"{mission}: it has no 'requirements': nothing to check")
    path = record / RECORD_FILE if record.is_dir() else record
    found = check_record(compile_mission(model, catalogue), path)
    lines = [_as_json(found)] if as_json else list(_lines(model, found))
    for line in lines:
        print(line if as_json else printable(line))  # noqa: T201
    fulfilled = all(it.fulfilled for it in found.results)
    return ExitCode.SUCCESS if fulfilled else ExitCode.ENDED_SAFELY


def _lines(mission: Mission, found: CheckedRecord) -> Iterator[str]:
    for it in found.results:
        figure = f" ({it.figure})" if it.figure else ""
        yield f"{STANDINGS[it.fulfilled]}: {it.name}{figure}"
    if found.missing:
        yield f"the record does not answer: {', '.join(found.missing)}"
    if not found.ended:
        yield f"the flight of {mission.name} had not ended: what has not happened may still do so"


def _as_json(found: CheckedRecord) -> str:
    return json.dumps(
        {
            "requirements": [it._asdict() for it in found.results],
            "missing": list(found.missing),
            "ended": found.ended,
        },
        indent=2,
    )
