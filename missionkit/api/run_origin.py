"""Origin of a run: the files and options it started from, and differences to them now."""

from __future__ import annotations

import difflib
import hashlib
import json
import os
import shlex
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from pydantic import Field, TypeAdapter, ValidationError

from missionkit.api.missions import LoadedMission
from missionkit.chart.model.mission import Mission
from missionkit.errors import UsageError
from missionkit.recorder.checkpoint import opened, sealed, write_surely
from missionkit.recorder.value_codec import NotReadableError, written
from missionkit.version import __version__

ORIGIN_FILE = "origin.json"
LINES_SHOWN = 40  # lines of differences


class Origin(NamedTuple):
    """A run's order, and the text of every file it stands on."""

    mission: str
    settings: tuple[str, ...]
    plugins: tuple[str, ...]
    seed: Annotated[int, Field(ge=0)]
    faults: tuple[str, ...]
    parameters: Mapping[str, Any]
    targets: tuple[str, ...]
    texts: Mapping[str, str]  # name as the mission gives it -> text
    version: str


class Origins(NamedTuple):
    """The origin of a run, and that of the run that it resumes."""

    now: Origin
    before: Origin | None = None


def origin_of_loaded(
    mission: LoadedMission, *, seed: int = 0, faults: Iterable[str] = ()
) -> Origin:
    """Return what a flight from Python stands on, files as they are now.

    Args:
        mission: that is flown.
        seed: of a flight in the simulator.
        faults: of a flight in the simulator.
    """
    return origin_of(
        mission.model,
        mission.path,
        settings=[f"{name}={value}" for name, value in mission.settings.items()],
        plugins=[it for it in mission.plugins if isinstance(it, Path)],
        seed=seed,
        faults=faults,
    )


def origin_of(
    mission: Mission,
    path: Path,
    *,
    settings: Iterable[str] = (),
    plugins: Iterable[Path] = (),
    seed: int = 0,
    faults: Iterable[str] = (),
) -> Origin:
    """Return what a flight stands on, files as they are now.

    Args:
        mission: that is flown.
        path: of its file.
        settings: of its parameters, NAME=VALUE.
        plugins: files.
        seed: of a flight in the simulator.
        faults: of a flight in the simulator.
    """
    root, plugins = path.resolve().parent, tuple(plugins)
    world = () if mission.world is None else (root / mission.world,)
    files = (path, *mission.included, *world, *plugins)
    return Origin(
        str(path.resolve()),
        tuple(settings),
        tuple(str(it.resolve()) for it in plugins),
        seed,
        tuple(faults),
        json.loads(json.dumps(mission.params)),  # without the places of texts and lists
        tuple(mission.targets),
        {os.path.relpath(it.resolve(), root): text_of(it) for it in files},
        __version__,
    )


def stamp(origin: Origin) -> str:
    """Return a digest of all that a flight stands on; a checkpoint carries it."""
    parts = (origin.parameters, origin.targets, origin.texts, origin.version)
    return hashlib.sha256(written(parts).encode()).hexdigest()


def keep_origin(folder: Path, origin: Origin) -> None:
    """Write it into the folder of the run."""
    write_surely(folder / ORIGIN_FILE, sealed(origin))


def forget_origin(folder: Path) -> None:
    """Remove it: the flight has ended."""
    (folder / ORIGIN_FILE).unlink(missing_ok=True)


def found_origin(folder: Path) -> Origin:
    """Return what the run in a folder was started from.

    Raises:
        UsageError: there is nothing to resume.
    """
    path = folder / ORIGIN_FILE
    if not path.is_file():
        ended = (folder / "summary.json").is_file()
        why = "the flight has ended" if ended else f"it holds no {ORIGIN_FILE}"
        raise UsageError(f"{folder}: nothing to resume: {why}")
    try:
        origin = opened(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError as error:
        raise UsageError(f"{path}: cannot be used: not UTF-8 text") from error
    except (ValueError, NotReadableError) as error:
        raise UsageError(f"{path}: cannot be used: {error}") from error
    try:
        return TypeAdapter(Origin).validate_python(origin, strict=True)
    except ValidationError as error:
        raise UsageError(f"{path}: cannot be used: it does not describe a run") from error


def check_same(before: Origin, now: Origin, folder: Path, *, force: bool) -> None:
    """Refuse a mission that has changed since the run was started, unless forced.

    Args:
        before: as read from the folder of the run.
        now: of the files and options given for resuming.
        folder: of the run, for the message.
        force: resume with the changed mission; changed targets are refused all the same.

    Raises:
        UsageError: it was, and that is not wanted or cannot be flown; names the differences.
    """
    lines = list(differences(before, now))
    if before.targets != now.targets:
        raise UsageError("the targets differ from those of the run, for which the filter was built")
    if lines and not force:
        more = [f"... {len(lines) - LINES_SHOWN} more lines"] if len(lines) > LINES_SHOWN else []
        head = f"{folder}: the mission has changed since; --force resumes with it as it is now"
        raise UsageError("\n".join([head, *lines[:LINES_SHOWN], *more]))


def differences(before: Origin, now: Origin) -> Iterator[str]:
    """Yield lines that say in what two origins differ: files as unified differences."""
    yield from changes(before.texts, now.texts)
    for name in sorted({*before.parameters, *now.parameters}):
        was, is_now = before.parameters.get(name), now.parameters.get(name)
        if was != is_now:
            yield f"parameter {name}: {was} as flown, {is_now} now"
    if before.version != now.version:
        yield f"missionkit: {before.version} as flown, {now.version} now"


def changes(before: Mapping[str, str], now: Mapping[str, str]) -> Iterator[str]:
    """Yield the unified differences of texts, by the names of their files."""
    for name in sorted({*before, *now}):
        old, new = before.get(name, "").splitlines(), now.get(name, "").splitlines()
        titles = (f"{name} (as flown)", f"{name} (now)")
        yield from difflib.unified_diff(old, new, *titles, n=0, lineterm="")


def plugins_named(origin: Origin) -> str:
    """Return the options that name the plug-in files of a run."""
    return " ".join(f"--plugin {shlex.quote(path)}" for path in origin.plugins)


def plugin_changes(origin: Origin, plugins: Iterable[Path]) -> list[str]:
    """Return lines that say in what plug-in files differ from those of a run.

    Args:
        origin: of the run.
        plugins: as named now; what is no file is left out.
    """
    root = Path(origin.mission).parent
    names = [os.path.relpath(path.resolve(), root) for path in plugins if path.is_file()]
    texts = {name: text_of(root / name) for name in names}
    flown = {name: text for name, text in origin.texts.items() if name in texts}
    return list(changes(flown, texts))


def text_of(path: Path) -> str:
    """Return the text of a file; of a binary file, such as a map's image, its digest."""
    data = path.read_bytes()
    try:
        return data.decode()
    except UnicodeDecodeError:
        return f"{len(data)} bytes, SHA-256 {hashlib.sha256(data).hexdigest()}"
