"""`missionkit import`: files of other programs."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Literal, NamedTuple, cast

from missionkit.api.missions import assemble
from missionkit.api.validation import problems_of
from missionkit.chart.load import parse
from missionkit.chart.text.foreign_files import LOGS, ForeignKind, foreign_kind
from missionkit.cli.interchange_output import home_of, ledger_path, require_new, tell, write
from missionkit.errors import ExitCode, FileError, Level, Problem, UsageError, nearest, printable
from missionkit.interchange.bounded_input import ForeignFileError, json_of, read, xml_of
from missionkit.interchange.calibration import camera_text
from missionkit.interchange.charts.chart_text import chart_text
from missionkit.interchange.charts.xstate_chart import scxml_of
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.mission_text import mission_text
from missionkit.interchange.plan_fitting import FitOptions, fit
from missionkit.interchange.plan_formats import plan_from

CALIBRATIONS = (ForeignKind.OPENCV, ForeignKind.ROS_CAMERA)
CHARTS = (ForeignKind.SCXML, ForeignKind.XSTATE)
HEIGHTS, AREAS = ("above_home", "agl", "amsl"), ("fence", "survey")
WRONG_KIND = "not a file that missionkit knows; it imports {}"


class ImportOptions(NamedTuple):
    """Options of the command."""

    file: Path
    out: Path | None
    home: str | None
    height: float | None
    heights: str | None
    spacing: float | None
    areas: str
    flat_ground: bool
    strict: bool
    force: bool


def import_file(wanted: ImportOptions) -> ExitCode:
    """Read a file, write what it is for missionkit, and print the ledger.

    Raises:
        UsageError: it cannot be read, nothing in it can be used, or the output exists.
    """
    _require_sound(wanted)
    raw = read(wanted.file)
    kind = foreign_kind(raw)
    if kind is None:
        known = ", ".join(sorted(it for it in ForeignKind if it not in LOGS))
        raise UsageError(f"{wanted.file}: {WRONG_KIND.format(known)}")
    if kind in LOGS:
        raise UsageError(f"{wanted.file}: this is a {kind}: missionkit log {wanted.file}")
    ledger = Ledger(wanted.file.name, str(kind))
    try:
        text = _converted(raw, kind, wanted, ledger)
    except ForeignFileError as error:
        if ledger.entries or ledger.added:
            tell(ledger)
        raise UsageError(f"{wanted.file}: {error}") from error
    tell(ledger)
    if wanted.strict and (refused := ledger.counts()["refused"]):
        raise UsageError(f"{wanted.file}: {refused} refused, nothing was written (--strict)")
    if wanted.out is None:
        print(text, end="")  # noqa: T201
    else:
        write(wanted.out, text.encode(), force=wanted.force)
        write(ledger_path(wanted.out), ledger.as_json().encode(), force=True)
    return _checked(text, wanted) if kind not in CALIBRATIONS else ExitCode.SUCCESS


def _require_sound(wanted: ImportOptions) -> None:
    """Refuse options that make no sense, before anything is read.

    Raises:
        UsageError: one does not.
    """
    if wanted.out is not None:
        require_new(wanted.out, force=wanted.force)
    if wanted.heights is not None and wanted.heights not in HEIGHTS:
        raise UsageError(f"--heights {wanted.heights}: unknown; {nearest(wanted.heights, HEIGHTS)}")
    if wanted.areas not in AREAS:
        raise UsageError(f"--areas {wanted.areas}: unknown; {nearest(wanted.areas, AREAS)}")
    for name, value in (("height", wanted.height), ("spacing", wanted.spacing)):
        if value is not None and not 0.0 < value < 10_000.0:
            raise UsageError(f"--{name} {value:g}: expected metres, more than 0")


def _converted(raw: bytes, kind: ForeignKind, wanted: ImportOptions, ledger: Ledger) -> str:
    if kind in CALIBRATIONS:
        return camera_text(raw, ledger)
    if kind in CHARTS:
        xstate = kind is ForeignKind.XSTATE
        root = scxml_of(json_of(raw), ledger) if xstate else xml_of(raw)
        aside = Ledger(ledger.source, ledger.form) if xstate else ledger
        text = chart_text(root, wanted.file.stem, aside)
        ledger.added += aside.added if xstate else []
        return text
    areas = cast("Literal['survey', 'fence']", wanted.areas)
    heights = cast("Literal['above_home', 'agl', 'amsl'] | None", wanted.heights)
    options = FitOptions(
        home_of(wanted.home), wanted.height, heights, wanted.flat_ground, wanted.spacing
    )
    plan = fit(plan_from(raw, kind, areas, ledger), options, ledger)
    return mission_text(plan, wanted.file.stem)


def _checked(text: str, wanted: ImportOptions) -> ExitCode:
    """Check the mission as `validate` does, and say what it finds."""
    name = str(wanted.out or wanted.file)
    catalogue = assemble(())
    try:
        found: Sequence[Problem] = problems_of(parse(text, name, catalogue), catalogue)
    except FileError as error:
        found = error.problems
    for problem in found:
        print(printable(f"{problem.level}: {problem}"), file=sys.stderr)  # noqa: T201
    wrong = any(it.level is Level.ERROR for it in found)
    return ExitCode.BAD_FILE if wrong else ExitCode.SUCCESS
