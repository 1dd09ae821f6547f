"""The names that `missionkit` exports: lazily, and the same to a type checker as to Python."""

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

import missionkit
from missionkit import kernel_cache


def imported_for_types():
    """Name and home of everything that a type checker sees."""
    tree = ast.parse(Path(missionkit.__file__).read_text())
    guarded = next(it for it in tree.body if isinstance(it, ast.If))
    return {
        alias.asname: node.module
        for node in guarded.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


def test_a_type_checker_sees_what_python_gives():
    seen = imported_for_types()
    assert sorted([*seen, "__version__"]) == missionkit.__all__ == dir(missionkit)
    for name, home in seen.items():
        assert getattr(missionkit, name) is getattr(sys.modules[home], name)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="has no attribute 'lod'"):
        missionkit.lod  # noqa: B018


def test_importing_it_imports_nothing_heavy():
    script = "import json, sys, missionkit; print(json.dumps(sorted(sys.modules)))"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True)
    loaded = {name for name in json.loads(run.stdout) if name.startswith("missionkit")}
    assert loaded == {"missionkit", "missionkit.version"}
    assert not {"numpy", "pydantic", "asyncio"} & set(json.loads(run.stdout))


def test_a_campaign_is_a_function_whatever_was_imported():
    import missionkit.campaigns.campaign_plan  # noqa: PLC0415

    assert callable(missionkit.campaign)


def test_the_public_names_do_not_affect_a_kernels_digest(tmp_path):
    (tmp_path / "missionkit").mkdir()
    (tmp_path / "missionkit" / "kernel.py").write_text("from missionkit import helper\n")
    (tmp_path / "missionkit" / "helper.py").write_text("")
    face = tmp_path / "missionkit" / "__init__.py"
    face.write_text("")
    before = kernel_cache.digest("missionkit.kernel", tmp_path)
    face.write_text("VERSION = 2\n")
    assert kernel_cache.digest("missionkit.kernel", tmp_path) == before
    (tmp_path / "missionkit" / "helper.py").write_text("x = 1\n")
    assert kernel_cache.digest("missionkit.kernel", tmp_path) != before
