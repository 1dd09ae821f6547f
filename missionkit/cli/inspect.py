"""The commands that look at missions or write new files, and fly nothing."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from missionkit.chart.contracts import unmet
from missionkit.chart.load import load
from missionkit.chart.model import Mission
from missionkit.cli.catalogue import assemble, overrides
from missionkit.errors import ExitCode, FileError, Problem, UsageError, nearest


def validate(
    path: Path, settings: Iterable[str], plugins: Iterable[Path], *, as_json: bool
) -> ExitCode:
    """Check a mission file and say what is wrong with it."""
    catalogue = assemble(plugins)
    try:
        mission = load(path, catalogue, overrides(settings))
        problems: Sequence[Problem] = unmet(mission, catalogue)
        world = None if mission.world is None else path.parent / mission.world
        if world is not None:
            _check_world(world)
    except FileError as error:
        problems = error.problems
    else:
        if not problems and not as_json:
            _say(f"{path}: ok ({_size(mission)})")
    if as_json:
        _say(json.dumps({"file": str(path), "problems": [_plain(it) for it in problems]}, indent=2))
    elif problems:
        print(*problems, sep="\n", file=sys.stderr)  # noqa: T201
    return ExitCode.BAD_FILE if problems else ExitCode.SUCCESS


def schema(kind: str, plugins: Iterable[Path], folder: Path | None) -> None:
    """Print one schema, or write both into a folder."""
    from missionkit.chart.schema import dumps, mission_schema, model_schema  # noqa: PLC0415
    from missionkit.sim.world import World  # noqa: PLC0415

    catalogue = assemble(plugins)
    texts = {"mission": dumps(mission_schema(catalogue)), "world": dumps(model_schema(World))}
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            (folder / f"{name}.schema.json").write_text(text, encoding="utf-8")
    elif kind in texts:
        _say(texts[kind].rstrip("\n"))
    else:
        raise UsageError(f"unknown schema {kind!r}; {nearest(kind, texts)}")


def graph(path: Path, out: Path | None, settings: Iterable[str], plugins: Iterable[Path]) -> None:
    """Draw a chart as Mermaid, SVG or PNG."""
    from missionkit.chart.contracts import fulfilled  # noqa: PLC0415
    from missionkit.chart.diagram import mermaid  # noqa: PLC0415
    from missionkit.chart.picture import svg  # noqa: PLC0415

    catalogue = assemble(plugins)
    mission = fulfilled(load(path, catalogue, overrides(settings)), catalogue)
    if out is None:
        _say(mermaid(mission).rstrip("\n"))
        return
    writers = {".mmd": mermaid, ".svg": svg}
    if out.suffix not in writers:
        raise UsageError(f"--out {out}: expected a file that ends in .mmd or .svg")
    out.write_text(writers[out.suffix](mission), encoding="utf-8")
    _say(str(out))


def new(kind: str, name: str, to: Path) -> None:
    """Write a working example."""
    from missionkit.cli.scaffold import new as write  # noqa: PLC0415

    catalogue = assemble()
    taken = {"guard": catalogue.guards, "behavior": catalogue.behaviors}.get(kind, {})
    for path in write(kind, name, to, taken):
        _say(str(path))


def _check_world(path: Path) -> None:
    from missionkit.chart.load import load_model  # noqa: PLC0415
    from missionkit.sim.world import World  # noqa: PLC0415

    load_model(path, World)


def _size(mission: Mission) -> str:
    failsafes = len(mission.failsafes)
    return f"{len(mission.by_name())} states, {len(mission.guards)} guards, {failsafes} failsafes"


def _plain(problem: Problem) -> dict[str, str | int]:
    place = problem.place
    return {
        "file": place.file,
        "line": place.line,
        "column": place.column,
        "message": problem.message,
    }


def _say(text: str) -> None:
    print(text)  # noqa: T201
