"""The page's files: small, complete, with unchanged libraries, and fetching from nobody."""

import gzip
import re
from hashlib import sha256
from pathlib import Path

import pytest

from missionkit.page.server.static_files import WEB, static_files

VENDOR = WEB / "vendor"
LIMIT = 250_000  # bytes, gzipped
OWN = sorted(it for it in WEB.rglob("*") if it.is_file() and VENDOR not in it.parents)


def sums(name: str) -> dict[str, str]:
    lines = (VENDOR / name).read_text(encoding="utf-8").splitlines()
    return {file: digest for digest, file in (line.split() for line in lines)}


def as_published(file: str, data: bytes) -> bytes:
    """Undo what README.md says was changed: paths for names of packages."""
    names = (("../preact/hooks.js", "preact/hooks"), ("../preact/preact.js", "preact"))
    names += (
        ("./preact.js", "preact"),
        ("../signals-core/signals-core.js", "@preact/signals-core"),
    )
    for path, name in names:
        data = data.replace(f'from"{path}"'.encode(), f'from"{name}"'.encode())
    return data


def test_libraries_are_those_that_were_published():
    files = {
        it.relative_to(VENDOR).as_posix(): it.read_bytes()
        for it in VENDOR.rglob("*")
        if it.suffix in {".js", ".css"} or it.name == "LICENSE"
    }
    assert {name: sha256(data).hexdigest() for name, data in files.items()} == sums("HASHES")
    published = sums("PUBLISHED")
    assert set(published) == {name for name in files if not name.endswith("LICENSE")}
    for name, digest in published.items():
        assert sha256(as_published(name, files[name])).hexdigest() == digest, name


def test_every_library_has_its_licence():
    for folder in (it for it in VENDOR.iterdir() if it.is_dir()):
        assert "Permission is hereby granted" in (folder / "LICENSE").read_text() or (
            "Apache License" in (folder / "LICENSE").read_text()
        )


def test_the_page_is_small():
    total = sum(len(gzip.compress(it.read_bytes())) for it in WEB.rglob("*") if it.is_file())
    assert total <= LIMIT, total


@pytest.mark.parametrize("file", OWN, ids=lambda it: it.name)
def test_nothing_is_fetched_from_elsewhere_or_runs_inline(file: Path):
    text = file.read_text(encoding="utf-8")
    assert not re.findall(r"(?:https?:)?//[\w-]+\.\w+", text)
    assert not re.findall(
        r"\beval\(|new Function|innerHTML|insertAdjacentHTML|document\.write", text
    )
    if file.suffix == ".html":
        assert not re.findall(r"\sstyle=|\son\w+=|<style|<script(?![^>]*\ssrc=)", text)


def test_every_module_that_is_imported_is_served():
    served = static_files()
    for name, file in served.items():
        if not name.startswith("app/"):
            continue
        for path in re.findall(r'(?:from|import\()\s*"([^"]+)"', file.data.decode()):
            found = (WEB / name).parent / path
            assert found.resolve().relative_to(WEB.resolve()).as_posix() in served, (name, path)
