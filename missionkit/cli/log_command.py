"""`missionkit log`: a log of an autopilot as the record of a flight."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from missionkit.api.missions import assemble
from missionkit.chart.load import load
from missionkit.chart.model.mission import Mission
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.chart.semantics.requirement_watch import STANDINGS
from missionkit.chart.text.foreign_files import HEAD, LOGS, ForeignKind, foreign_kind
from missionkit.chart.text.regular_file import read_bytes
from missionkit.cli.interchange_output import tell
from missionkit.cli.overrides import overrides
from missionkit.errors import ExitCode, UsageError, printable
from missionkit.geodesy import Origin
from missionkit.interchange.bounded_input import ForeignFileError
from missionkit.interchange.flight_logs.log_records import Verdicts, origin_of, records
from missionkit.interchange.flight_logs.log_samples import MOST_BYTES, Fix, FlightLog
from missionkit.interchange.flight_logs.reading import READERS, ledger_of
from missionkit.interchange.flight_logs.requirement_answers import RequirementAnswers
from missionkit.messages import Estimate
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.geographic_messages import Georeference
from missionkit.recorder.plot import draw
from missionkit.recorder.run_folder import run_folder
from missionkit.recorder.scenery import Scenery

Answers = Callable[[Estimate], Verdicts]


def log(
    path: Path,
    out: Path,
    mission: Path | None,
    settings: Iterable[str],
    plugins: Iterable[Path],
) -> ExitCode:
    """Read a log, write its record and picture into a new folder, check the requirements.

    Args:
        path: of the log.
        out: parent of the folder.
        mission: whose requirements are checked, and whose origin is taken.
        settings: NAME=VALUE, as of `--set`.
        plugins: files with plug-ins.

    Raises:
        FileError: the mission cannot be loaded.
        UsageError: the file is not a log, or is damaged.
    """
    kind = _kind(path)
    catalogue = assemble(plugins)
    model = None if mission is None else load(mission, catalogue, overrides(settings))
    asked = None if model is None else RequirementAnswers(compile_mission(model, catalogue))
    try:
        read = READERS[kind](path)
        origin = origin_of(read, model)
    except ForeignFileError as error:
        raise UsageError(f"{path}: {error}") from error
    folder = run_folder(out, path.stem, "log")
    _write(folder, read, origin, model, _nothing if asked is None else asked.of)
    ledger = ledger_of(path.name, kind, read)
    (folder / "ledger.json").write_text(ledger.as_json(), encoding="utf-8")
    tell(ledger)
    print(printable(str(folder)))  # noqa: T201
    found = () if asked is None else asked.results()
    for it in found:
        figure = f" ({it.figure})" if it.figure else ""
        print(printable(f"{STANDINGS[it.fulfilled]}: {it.name}{figure}"))  # noqa: T201
    return ExitCode.SUCCESS if all(it.fulfilled for it in found) else ExitCode.ENDED_SAFELY


def _kind(path: Path) -> ForeignKind:
    head = read_bytes(path, HEAD)
    kind = foreign_kind(head)
    if kind is None or kind not in LOGS:
        known = ", ".join(sorted(LOGS))
        what = "not a log that missionkit knows" if kind is None else f"this is a {kind}"
        hint = "" if kind is None else f"; missionkit import {path} reads it"
        raise UsageError(f"{path}: {what}; it reads {known}{hint}")
    if path.stat().st_size > MOST_BYTES:
        raise UsageError(f"{path}: larger than {MOST_BYTES >> 20} MiB")
    return kind


def _nothing(_: Estimate) -> Verdicts:
    return ()


def _write(
    folder: Path, read: FlightLog, origin: Origin, mission: Mission | None, answers: Answers
) -> None:
    first = next(it.at for it in read.samples if isinstance(it, Fix))
    date = (read.began or 0.0) + first
    reference = Georeference.fixed(origin, lambda: date)
    with FlightRecorder(folder, reference=reference) as recorder:
        for record in records(read, origin, mission, answers):
            recorder.write(record)
        track = recorder.track
    draw(folder / "track.png", track, Scenery(), folder.name, f"{len(track.times)} positions")
