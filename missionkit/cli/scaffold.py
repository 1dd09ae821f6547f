"""`missionkit new`: a working guard, behaviour or mission to start from."""

from __future__ import annotations

import keyword
import re
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from string import Template

from missionkit.cli import scaffold_templates
from missionkit.errors import UsageError, nearest

Files = dict[str, str]
"""Text by path relative to the folder that is written into."""


def guard_files(name: str, taken: Collection[str] = ()) -> Files:
    """Return a package with one guard, its entry point and its test.

    Raises:
        UsageError: `name` is not an identifier in lower case, or is taken.
    """
    checked = _identifier(name, "guard", taken)
    return _package(
        checked,
        "guard",
        "guards",
        scaffold_templates.GUARD,
        scaffold_templates.GUARD_TEST,
        scaffold_templates.GUARD_USAGE,
    )


def behavior_files(name: str, taken: Collection[str] = ()) -> Files:
    """Return a package with one behaviour, its entry point and its test.

    Raises:
        UsageError: `name` is not an identifier in lower case, or is taken.
    """
    checked = _identifier(name, "behavior", taken)
    return _package(
        checked,
        "behavior",
        "behaviors",
        scaffold_templates.BEHAVIOR,
        scaffold_templates.BEHAVIOR_TEST,
        scaffold_templates.BEHAVIOR_USAGE,
    )


def mission_files(name: str, taken: Collection[str] = ()) -> Files:
    """Return a mission that flies to a place and back, and the world it is rehearsed in.

    Raises:
        UsageError: `name` has other characters than a-z, 0-9 and -, or is taken.
    """
    advice = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-0123456789") or "my-mission"
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", name):
        raise UsageError(
            f"{name!r} cannot name a mission: use a-z, 0-9 and '-', such as {advice!r}"
        )
    _refuse_taken(name, "mission", taken)
    return {
        f"{name}.yaml": Template(scaffold_templates.MISSION_FILE).substitute(name=name),
        f"worlds/{name}.yaml": Template(scaffold_templates.WORLD_FILE).substitute(name=name),
    }


SCAFFOLDS: Mapping[str, Callable[[str, Collection[str]], Files]] = {
    "guard": guard_files,
    "behavior": behavior_files,
    "mission": mission_files,
}


def new(kind: str, name: str, to: Path, taken: Collection[str] = ()) -> tuple[Path, ...]:
    """Write the files of `missionkit new KIND NAME --to FOLDER`; return their paths.

    Args:
        kind: guard, behavior or mission.
        name: as mission files will use it.
        to: the folder to write into; created when missing.
        taken: names of that kind that exist already.

    Raises:
        UsageError: an unknown kind, an unfit or taken name, or a file that exists already.
    """
    if kind not in SCAFFOLDS:
        raise UsageError(f"nothing called {kind!r} can be created: {nearest(kind, SCAFFOLDS)}")
    return write_files(to, SCAFFOLDS[kind](name, taken))


def write_files(folder: Path, files: Mapping[str, str]) -> tuple[Path, ...]:
    """Write all files below `folder`, or none when one of them exists.

    Raises:
        UsageError: a file exists already.
    """
    paths = {folder / path: text for path, text in files.items()}
    for path in paths:
        if path.exists():
            raise UsageError(f"{path} already exists: choose another name or folder")
    for path, text in paths.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    return tuple(paths)


def _package(name: str, what: str, group: str, code: str, test: str, usage: str) -> Files:
    """Fill in a package with one module and one test."""
    words = {
        "name": name,
        "what": what,
        "group": group,
        "module": f"missionkit_{name}",
        "folder": f"missionkit-{name.replace('_', '-')}",
        "Class": "".join(word.capitalize() for word in name.split("_")),
    }
    words["usage"] = Template(usage).substitute(words)
    texts = {
        "pyproject.toml": scaffold_templates.PROJECT,
        "README.md": scaffold_templates.READ_ME,
        f"{words['module']}.py": code,
        f"tests/test_{name}.py": test,
    }
    return {
        f"{words['folder']}/{path}": Template(text).substitute(words)
        for path, text in texts.items()
    }


def _identifier(name: str, what: str, taken: Collection[str]) -> str:
    """Return `name` if a module, a class and an entry point can be named after it."""
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name) or keyword.iskeyword(name):
        spaced = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name)
        advice = re.sub(r"[^a-z0-9]+", "_", spaced.lower()).strip("_0123456789")
        if not advice or keyword.iskeyword(advice):
            advice = f"my_{advice or what}"
        raise UsageError(f"{name!r} cannot name a {what}: use a-z, 0-9 and _, such as {advice!r}")
    _refuse_taken(name, what, taken)
    return name


def _refuse_taken(name: str, what: str, taken: Collection[str]) -> None:
    if name in taken:
        raise UsageError(
            f"there is already a {what} called {name!r}; taken: {', '.join(sorted(taken))}"
        )
