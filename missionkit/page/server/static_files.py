"""The files of the page: those of the package, found once; a request only picks one of them."""

from __future__ import annotations

import gzip
import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

WEB = Path(__file__).parents[1] / "web"
KINDS = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".mjs": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".json": "application/json",
    ".woff2": "font/woff2",
}


class StaticFile(NamedTuple):
    """One file, ready to be sent."""

    data: bytes
    packed: bytes  # the same, by gzip
    kind: str  # media type
    tag: str  # changes with the content


def static_files(folder: Path = WEB) -> Mapping[str, StaticFile]:
    """Return the files of the page by their path in its folder, "app/main.js"."""
    return {
        path.relative_to(folder).as_posix(): _file(path)
        for path in sorted(folder.rglob("*"))
        if path.suffix in KINDS and path.is_file()
    }


def _file(path: Path) -> StaticFile:
    data = path.read_bytes()
    tag = f'"{hashlib.sha256(data).hexdigest()[:16]}"'
    return StaticFile(data, gzip.compress(data, mtime=0), KINDS[path.suffix], tag)
