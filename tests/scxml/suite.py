"""The charts of a public SCXML suite: fetched once, kept in pytest's cache, never committed."""

from __future__ import annotations

import hashlib
import json
import re
import subprocess
import tarfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple
from xml.etree import ElementTree

PACKAGE = "@scion-scxml/test-framework@2.0.16"
ARCHIVE = "scion-scxml-test-framework-2.0.16.tgz"
SHA256 = "b813071f5691c7a36bab65ba5ce5aae479933395177447a6609c110bc936622b"
W3C = "w3c-ecma"  # the folder of the recommendation's own tests
AWAY = re.compile(r"ENOTFOUND|EAI_AGAIN|ECONN|ENETUNREACH|EHOSTUNREACH|ETIMEDOUT|E50\d|ENOTCACHED")
PATIENCE = 120.0  # s to fetch the package


class UnreachableError(Exception):
    """The package is not here and cannot be fetched."""


class Case(NamedTuple):
    """A chart, and what it must do."""

    name: str  # folder/file
    chart: ElementTree.Element
    script: dict[str, Any]  # initialConfiguration, events

    @property
    def w3c(self) -> bool:
        """Whether it is one of the recommendation's own tests."""
        return self.name.startswith(W3C)


@cache
def cases(folder: Path) -> tuple[Case, ...]:
    """Return every chart that comes with a script, by name.

    Raises:
        UnreachableError: npm or its registry cannot be reached.
    """
    return tuple(sorted(_read(_archive(folder)), key=lambda case: case.name))


def _read(archive: Path) -> Iterator[Case]:
    with tarfile.open(archive) as tar:
        members = {member.name: member for member in tar.getmembers()}

        def content(name: str) -> bytes:
            file = tar.extractfile(members[name])
            assert file is not None
            return file.read()

        for name in members:
            path = PurePosixPath(name)
            script = str(path.with_suffix(".json"))
            if path.parts[1] == "test" and path.suffix == ".scxml" and script in members:
                chart = ElementTree.fromstring(content(name))  # noqa: S314 - pinned by its hash
                label = str(path.relative_to("package/test").with_suffix(""))
                yield Case(label, chart, json.loads(content(script)))


def _archive(folder: Path) -> Path:
    kept = folder / ARCHIVE
    if not kept.exists():
        with TemporaryDirectory(dir=folder) as fresh:
            _fetch(Path(fresh))
            (Path(fresh) / ARCHIVE).replace(kept)
    assert hashlib.sha256(kept.read_bytes()).hexdigest() == SHA256, f"{kept} is not {PACKAGE}"
    return kept


def _fetch(folder: Path) -> None:
    command = ["npm", "pack", PACKAGE, "--pack-destination", str(folder)]
    try:
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=PATIENCE, check=False
        )
    except FileNotFoundError as error:
        raise UnreachableError("npm is not installed") from error
    except subprocess.TimeoutExpired as error:
        raise UnreachableError(f"npm did not answer within {PATIENCE:g} s") from error
    if done.returncode == 0:
        return
    away = AWAY.search(done.stderr)
    if away is None:
        raise RuntimeError(done.stderr)
    raise UnreachableError(f"npm's registry cannot be reached: {away[0]}")
