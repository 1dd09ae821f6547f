"""Where compiled kernels are kept: a folder named after all the sources that they are made of.

A kernel takes in those it calls and the constants it reads, also from other files. The folder of
a module's kernels carries a digest of its source and of everything of the package that it imports,
so that a change in any of them is a new folder, and a stale kernel is never run.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
from collections.abc import Iterator
from contextlib import suppress
from functools import cache, partial
from pathlib import Path
from typing import NamedTuple

from missionkit.private_folder import private, runtime_folder

PACKAGE = "missionkit"
FOLDERS_KEPT = 5
"""Folders of each module, the last used: switching between branches compiles nothing."""
SPARED = 3600.0  # s since its last use for which a folder is left alone: a process may fill it
IMPORT = re.compile(
    rf"^[ \t]*(?:from ({PACKAGE}[\w.]*) import (\([^)]*\)|[^\n]*)|import ({PACKAGE}[\w.]*))",
    re.MULTILINE,
)


def folder_for(module: str) -> Path | None:
    """Return where the kernels of a module are kept, None if nowhere can be written.

    Args:
        module: of the package, by its full name.
    """
    base = _base()
    if base is None:
        return None
    folder = base / f"{module}-{digest(module)[:16]}"
    try:
        folder.mkdir(exist_ok=True)
        os.utime(folder)  # last used now
    except OSError:
        return None
    _prune(base, module, folder)
    return folder


def _prune(base: Path, module: str, used: Path) -> None:
    """Remove the folders of a module's kernels that were used longest ago.

    Another process may remove the same ones meanwhile, or have one of them loaded: machine code
    that is loaded stays, and what is not found is compiled again.
    """
    name = re.compile(rf"{re.escape(module)}-[0-9a-f]{{16}}")
    ages: list[tuple[float, Path]] = []
    for folder in base.iterdir():
        if name.fullmatch(folder.name) and not folder.is_symlink():
            with suppress(OSError):
                ages.append((used.stat().st_mtime - folder.stat().st_mtime, folder))
    for age, folder in sorted(ages)[FOLDERS_KEPT:]:
        if age > SPARED:
            shutil.rmtree(folder, ignore_errors=True)


def digest(module: str, root: Path | None = None) -> str:
    """Return a digest of the sources of a module and of all of the package that it imports.

    Args:
        module: of the package, by its full name.
        root: the folder that holds the package; where this file is by default.
    """
    read = _own_source if root is None else partial(_source, root)
    found: dict[str, Source] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if name not in found and (source := read(name)) is not None:
            found[name] = source
            waiting += source.imports
    total = hashlib.sha256()
    for name, (text, _) in sorted(found.items()):
        total.update(f"{name} {len(text)}\n".encode() + text)
    return total.hexdigest()


class Source(NamedTuple):
    """Source of a module of the package, and the modules of the package that it may import."""

    text: bytes
    imports: tuple[str, ...]


@cache  # each of some 200 kernels asks for most of these modules
def _own_source(module: str) -> Source | None:
    return _source(Path(__file__).parents[1], module)


def _source(root: Path, module: str) -> Source | None:
    stem = os.path.join(root, *module.split("."))  # noqa: PTH118 - pathlib took a tenth of a start
    for path in (f"{stem}.py", f"{stem}/__init__.py"):
        with suppress(FileNotFoundError, NotADirectoryError):
            text = Path(path).read_bytes()
            return Source(text, tuple(_imported(text.decode())))
    return None


def _imported(source: str) -> Iterator[str]:
    """Yield the modules of the package that a source may import.

    The package's own `__init__` is left out: it is the public API, which holds no kernels and
    names modules of all of missionkit.
    """
    for package, names, whole in IMPORT.findall(source):
        if (package or whole) != PACKAGE:
            yield package or whole
        for name in re.findall(r"\w+", names):
            yield f"{package}.{name}"


@cache
def _base() -> Path | None:
    """Return the first place that can be written.

    `NUMBA_CACHE_DIR`, beside the package, the user's cache, the user's runtime folder.
    """
    for place, shared in _places():
        with suppress(OSError):
            if shared:
                place.mkdir(parents=True, exist_ok=True)
            else:
                private(place)
            if os.access(place, os.W_OK | os.X_OK):
                return place
    return None


def _places() -> Iterator[tuple[Path, bool]]:
    """Yield places, and whether others may be let in there as they are beside the package."""
    if named := os.environ.get("NUMBA_CACHE_DIR"):
        yield Path(named), True
    yield Path(__file__).parent / "__pycache__" / "kernels", True
    with suppress(RuntimeError):  # a user without a home
        home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        yield Path(home) / f"{PACKAGE}-kernels", False
    yield runtime_folder() / "kernels", False
