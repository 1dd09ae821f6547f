"""A stale kernel is never run, and a cache that cannot be written does not prevent a flight."""

from __future__ import annotations

import os
import shutil
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from missionkit import kernel_cache
from missionkit.jit import compiled
from missionkit.kernel_cache import digest

SOURCES = {
    "inner": "LIMIT = 2.0\n",
    "outer": "from missionkit.inner import LIMIT\n\n\ndef f(x):\n    return x * LIMIT\n",
    "package/__init__": "from missionkit import (\n    outer,\n)\n",
    "deep": "import missionkit.package\n",
    "apart": "x = 1\n",
}


@pytest.fixture
def tree(tmp_path):
    for name, text in SOURCES.items():
        path = tmp_path / "missionkit" / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    return tmp_path


@pytest.mark.parametrize("module", ["inner", "outer", "package", "deep"])
def test_a_change_in_anything_that_is_imported_is_noticed(tree, module):
    before = digest(f"missionkit.{module}", tree)
    assert digest(f"missionkit.{module}", tree) == before
    (tree / "missionkit/apart.py").write_text("x = 2\n")
    assert digest(f"missionkit.{module}", tree) == before
    (tree / "missionkit/inner.py").write_text("LIMIT = 3.0\n")
    assert digest(f"missionkit.{module}", tree) != before


KERNEL = """\
from missionkit.jit import compiled
from missionkit.inner import LIMIT


@compiled
def twice(x):
    return LIMIT * x
"""
CALL = (
    "from missionkit.kernel import twice; print(twice(1.0), sum(twice.stats.cache_hits.values()))"
)


def test_a_kernel_that_takes_a_constant_from_another_file_follows_it(tree):
    """The numbers are those of the sources, with and without a kernel that was kept."""
    package = Path(kernel_cache.__file__).parent
    for name in ("jit", "kernel_cache", "private_folder"):
        shutil.copy(package / f"{name}.py", tree / "missionkit")
    (tree / "missionkit/kernel.py").write_text(KERNEL)

    def called():
        line = [sys.executable, "-c", CALL]
        env = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}  # bytecode goes by time and size
        options = {"cwd": tree, "capture_output": True, "text": True, "env": env}
        return subprocess.run(line, check=True, **options).stdout

    assert called() == "2.0 0\n"
    assert called() == "2.0 1\n"
    stamp = (tree / "missionkit/inner.py").stat()
    (tree / "missionkit/inner.py").write_text("LIMIT = 3.0\n")
    os.utime(tree / "missionkit/inner.py", ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
    assert called() == "3.0 0\n"


def places(monkeypatch, *found):
    monkeypatch.setattr(kernel_cache, "_places", lambda: iter(found))
    kernel_cache._base.cache_clear()


@pytest.fixture
def fresh():
    yield
    kernel_cache._base.cache_clear()


@pytest.mark.usefixtures("fresh")
def test_the_first_place_that_can_be_written_is_taken(monkeypatch, tmp_path):
    taken = tmp_path / "file"
    taken.write_text("")
    places(monkeypatch, (taken / "below", True), (taken, False), (tmp_path / "own", False))
    folder = kernel_cache.folder_for("missionkit.geometry")
    assert folder.parent == tmp_path / "own"
    assert stat.S_IMODE(folder.parent.stat().st_mode) == 0o700


@pytest.mark.usefixtures("fresh")
def test_without_any_place_kernels_are_compiled_and_not_kept(monkeypatch, tmp_path):
    taken = tmp_path / "file"
    taken.write_text("")
    places(monkeypatch, (taken / "below", True), (taken, False))
    assert kernel_cache.folder_for("missionkit.geometry") is None
    assert compiled(lambda x: x + 1.0)(1.0) == 2.0


@pytest.mark.usefixtures("fresh")
def test_a_folder_that_another_user_may_have_planted_holds_no_kernels(monkeypatch, tmp_path):
    (tmp_path / "real").mkdir()
    (tmp_path / "linked").symlink_to(tmp_path / "real")
    places(monkeypatch, (tmp_path / "linked", False))
    assert kernel_cache.folder_for("missionkit.geometry") is None


@pytest.mark.usefixtures("fresh")
def test_of_each_module_the_five_folders_used_last_are_kept(monkeypatch, tmp_path):
    places(monkeypatch, (tmp_path, True))
    now = kernel_cache.folder_for("missionkit.geometry").stat().st_mtime
    for hours in range(9):
        folder = tmp_path / f"missionkit.geometry-{hours:016x}"
        folder.mkdir()
        (folder / "kernel.nbi").write_text("old")
        os.utime(folder, (now, now - 3600.0 * hours - 60.0))
    others = [tmp_path / it for it in ("missionkit.geometry_too-0000000000000000", "notes")]
    for folder in others:
        folder.mkdir()
        os.utime(folder, (0, 0))
    current = kernel_cache.folder_for("missionkit.geometry")
    kept = {f"missionkit.geometry-{hours:016x}" for hours in range(4)}
    assert {it.name for it in tmp_path.iterdir()} == {
        current.name,
        *kept,
        *(o.name for o in others),
    }


@pytest.mark.usefixtures("fresh")
def test_folders_that_other_processes_may_be_filling_are_left_alone(monkeypatch, tmp_path):
    places(monkeypatch, (tmp_path, True))
    for n in range(9):
        (tmp_path / f"missionkit.geometry-{n:016x}").mkdir()
    kernel_cache.folder_for("missionkit.geometry")
    assert len(list(tmp_path.iterdir())) == 10
