"""The commands that look at missions or write new files, and fly nothing."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from missionkit.api.missions import assemble
from missionkit.api.validation import checked as check
from missionkit.api.validation import problems_of
from missionkit.chart.load import load
from missionkit.chart.model.mission import Mission
from missionkit.cli import problem_report
from missionkit.cli.overrides import overrides
from missionkit.errors import ExitCode, FileError, Level, Problem, UsageError, nearest, printable

if TYPE_CHECKING:
    from missionkit.cli.campaign_overlay import CampaignOverlay

FORMATS = ("text", "json", "sarif")


def validate(
    paths: Sequence[Path],
    settings: Iterable[str],
    plugins: Iterable[Path],
    form: str = "text",
    *,
    strict: bool = False,
) -> ExitCode:
    """Check mission files and say all that is wrong with them.

    Args:
        paths: of mission files; problems of all are shown together.
        settings: NAME=VALUE, as of `--set`.
        plugins: files with plug-ins.
        form: a key of `FORMATS`.
        strict: whether warnings count as errors.

    Raises:
        UsageError: unknown format, or a setting without `=`.
    """
    if form not in FORMATS:
        raise UsageError(f"--format {form}: unknown; {nearest(form, FORMATS)}")
    values = overrides(settings)
    try:
        catalogue = assemble(plugins)
    except FileError as error:  # a plug-in file; without it the mission cannot be checked
        problems = list(error.problems)
        checked: dict[Path, tuple[Mission | None, list[Problem]]] = {}
    else:
        checked = {path: check(path, catalogue, values) for path in paths}
        problems = [problem for _, found in checked.values() for problem in found]
    if form == "text":
        _tell(checked, problems, strict=strict)
    else:
        _say(_for_programs(form, problems))
    return ExitCode.BAD_FILE if _refused(problems, strict=strict) else ExitCode.SUCCESS


def _refused(problems: Iterable[Problem], *, strict: bool) -> bool:
    return any(strict or problem.level is Level.ERROR for problem in problems)


def _tell(
    checked: Mapping[Path, tuple[Mission | None, list[Problem]]],
    problems: Sequence[Problem],
    *,
    strict: bool,
) -> None:
    """Say on stdout what is in order, on stderr what is not."""
    terminal, lines = sys.stderr.isatty(), problem_report.sources(problems)
    if problems:
        colours = terminal and not os.environ.get("NO_COLOR")
        _complain(problem_report.text(problems, lines, colours=colours))
    for path, (mission, found) in checked.items():
        name = printable(str(path))
        if mission is not None and not _refused(found, strict=strict):
            but = f", {problem_report.summary(found)}" if found else ""
            _say(f"{name}: ok{but} ({_size(mission)})")
        else:
            _complain(f"{name}: {problem_report.summary(found)}")
    if terminal and (hint := problem_report.schema_hint(problems, lines)):
        _complain(printable(hint))


def _for_programs(form: str, problems: Sequence[Problem]) -> str:
    from missionkit.cli.sarif import sarif  # noqa: PLC0415

    return sarif(problems) if form == "sarif" else problem_report.as_json(problems)


def explain(path: Path, settings: Iterable[str], plugins: Iterable[Path]) -> None:
    """Say a chart in plain sentences.

    Args:
        path: of the mission file.
        settings: NAME=VALUE, as of `--set`.
        plugins: files with plug-ins.

    Raises:
        FileError: the mission or a plug-in file cannot be loaded.
        UsageError: a setting has no `=`.
    """
    from missionkit.chart.prose.mission_text import explained  # noqa: PLC0415
    from missionkit.cli.explain_command import page, width  # noqa: PLC0415

    catalogue = assemble(plugins)
    mission = load(path, catalogue, overrides(settings))
    _say(page(explained(mission, catalogue), width()))


def schema(kind: str, plugins: Iterable[Path], folder: Path | None, of: Path | None = None) -> None:
    """Print one schema, or write all into a folder.

    Args:
        kind: mission, world or free_flyer_world.
        plugins: files.
        folder: to write into.
        of: a mission file, whose states, targets and guards the mission's schema then lists.
    """
    from missionkit.chart.model.json_schema import dumps, mission_schema, model_schema  # noqa: PLC0415
    from missionkit.chart.model.mission_names import names_in  # noqa: PLC0415
    from missionkit.sim.free_flyer.world import FreeFlyerWorld  # noqa: PLC0415
    from missionkit.sim.world import World  # noqa: PLC0415

    catalogue = assemble(plugins)
    names = {} if of is None else names_in(of, catalogue)
    texts = {
        "mission": dumps(mission_schema(catalogue, names)),
        "world": dumps(model_schema(World)),
        "free_flyer_world": dumps(model_schema(FreeFlyerWorld)),
    }
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            (folder / f"{name}.schema.json").write_text(text, encoding="utf-8")
    elif kind in texts:
        _say(texts[kind].rstrip("\n"))
    else:
        raise UsageError(f"unknown schema {kind!r}; {nearest(kind, texts)}")


def graph(
    path: Path,
    out: Path | None,
    settings: Iterable[str],
    plugins: Iterable[Path],
    campaign: Path | None = None,
) -> None:
    """Draw a chart as Mermaid or SVG, with the problems that `validate` finds in red.

    Args:
        path: of the mission.
        out: file to write; Mermaid on stdout without.
        settings: values of parameters.
        plugins: files.
        campaign: folder of one, whose flights are drawn over the chart.
    """
    from missionkit.chart.drawing.chart_overlay import NO_OVERLAY  # noqa: PLC0415
    from missionkit.chart.drawing.mermaid_text import mermaid  # noqa: PLC0415
    from missionkit.chart.drawing.problem_marks import marks  # noqa: PLC0415
    from missionkit.chart.drawing.svg_chart import svg  # noqa: PLC0415
    from missionkit.chart.model.state_contracts import fulfilled  # noqa: PLC0415

    flights = None if campaign is None else _flown(campaign, path, settings)
    files = tuple(plugins) or (() if flights is None else flights.plugins)
    catalogue = assemble(files)
    written = load(path, catalogue, overrides(settings) if flights is None else flights.values)
    overlay = NO_OVERLAY if flights is None else flights.overlay(path, written, catalogue)
    mission, found = fulfilled(written, catalogue), marks(written, problems_of(written, catalogue))
    if out is None:
        _say(mermaid(mission, found, overlay).rstrip("\n"))
        return
    writers = {".mmd": mermaid, ".svg": svg}
    if out.suffix not in writers:
        raise UsageError(f"--out {out}: expected a file that ends in .mmd or .svg")
    out.write_text(writers[out.suffix](mission, found, overlay), encoding="utf-8")
    _say(str(out))


def _flown(folder: Path, path: Path, settings: Iterable[str]) -> CampaignOverlay:
    from missionkit.cli.campaign_overlay import flown  # noqa: PLC0415 - heavy

    return flown(folder, path, overrides(settings))


def new(kind: str, name: str, to: Path) -> None:
    """Write a working example.

    Args:
        kind: guard, behavior or mission.
        name: of the plug-in or mission.
        to: existing folder.

    Raises:
        UsageError: the name is taken or not a word, or there are such files already.
    """
    from missionkit.cli.scaffold import new as write  # noqa: PLC0415

    taken = assemble().plugins.get(f"{kind}s", {})
    for path in write(kind, name, to, taken):
        _say(str(path))


def _size(mission: Mission) -> str:
    failsafes = len(mission.failsafes)
    return f"{len(mission.by_name())} states, {len(mission.guards)} guards, {failsafes} failsafes"


def _say(text: str) -> None:
    print(text)  # noqa: T201


def _complain(text: str) -> None:
    print(text, file=sys.stderr)  # noqa: T201
