from __future__ import annotations

import ast
import contextlib
import importlib
import inspect
import io
import sys
import tomllib

import pytest

from missionkit.chart.load import load
from missionkit.chart.model_file import load_model
from missionkit.chart.plugin_catalogue import builtin
from missionkit.cli.scaffold import SCAFFOLDS, behavior_files, guard_files, mission_files, new
from missionkit.errors import UsageError
from missionkit.sim.world import World


def import_from(folder, name, monkeypatch):
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    importlib.invalidate_caches()
    module = importlib.import_module(name)
    monkeypatch.delitem(sys.modules, name)
    return module


def run_generated_tests(folder):
    """Run pytest inside this process, as somebody would in the new folder."""
    with contextlib.redirect_stdout(io.StringIO()) as said:
        code = pytest.main(["-q", "-p", "no:cacheprovider", "-c", str(folder / "pyproject.toml"),
                            "--rootdir", str(folder), str(folder)])  # fmt: skip
    return code, said.getvalue()


@pytest.mark.parametrize(
    ("kind", "name", "passes"), [("guard", "too_fast", 4), ("behavior", "slow_climb", 1)]
)
def test_a_new_plugin_passes_its_own_test(tmp_path, monkeypatch, kind, name, passes):
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    new(kind, name, tmp_path)
    folder = tmp_path / f"missionkit-{name.replace('_', '-')}"
    code, said = run_generated_tests(folder)
    sys.modules.pop(f"missionkit_{name}", None)
    sys.modules.pop(f"test_{name}", None)
    assert code == 0, said
    assert f"{passes} passed" in said


@pytest.mark.parametrize(("kind", "group"), [("guard", "guards"), ("behavior", "behaviors")])
def test_the_entry_point_names_the_class_that_was_written(tmp_path, monkeypatch, kind, group):
    new(kind, "my_thing", tmp_path)
    folder = tmp_path / "missionkit-my-thing"
    project = tomllib.loads((folder / "pyproject.toml").read_text())
    module_name, class_name = project["project"]["entry-points"][f"missionkit.{group}"][
        "my_thing"
    ].split(":")
    plugin = getattr(import_from(folder, module_name, monkeypatch), class_name)
    assert plugin.kind == "my_thing"
    assert inspect.getdoc(plugin)
    assert plugin()
    assert not inspect.isabstract(plugin)
    extended = builtin().with_file(folder / f"{module_name}.py")
    assert "my_thing" in extended.group(group)


def test_a_new_mission_is_valid_with_its_world(tmp_path):
    mission_path, world_path = new("mission", "first-flight", tmp_path)
    mission = load(mission_path, builtin())
    assert mission.name == "first-flight"
    assert list(mission.states) == ["idle", "out", "back", "land"]
    assert load_model(world_path, World).world == "first-flight"


@pytest.mark.parametrize("kind", list(SCAFFOLDS))
def test_nothing_is_written_over(tmp_path, kind):
    paths = new(kind, "thing", tmp_path)
    paths[-1].write_text("mine")
    for path in paths[:-1]:
        path.unlink()
    with pytest.raises(UsageError, match="already exists"):
        new(kind, "thing", tmp_path)
    assert paths[-1].read_text() == "mine"
    assert not any(path.exists() for path in paths[:-1])


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("WindAbove", "wind_above"),
        ("wind-above", "wind_above"),
        ("3rd", "rd"),
        ("class", "my_class"),
        ("../evil", "evil"),
        ("", "my_guard"),
        ("_private", "private"),
        ("größe", "gr_e"),
    ],
)
def test_an_unfit_name_is_refused_with_a_better_one(name, advice):
    with pytest.raises(UsageError) as caught:
        guard_files(name)
    assert str(caught.value) == (
        f"{name!r} cannot name a guard: use a-z, 0-9 and _, such as {advice!r}"
    )
    assert guard_files(advice)


@pytest.mark.parametrize(("name", "advice"), [("My Mission", "my-mission"), ("a/b", "a-b")])
def test_a_mission_name_may_have_dashes_only(name, advice):
    with pytest.raises(UsageError, match=f"such as '{advice}'"):
        mission_files(name)
    assert mission_files(advice)


def test_a_taken_name_is_refused():
    with pytest.raises(UsageError, match="already a behavior called 'go_to'; taken: go_to, hold"):
        behavior_files("go_to", taken=("hold", "go_to"))


def test_an_unknown_kind_says_the_nearest(tmp_path):
    with pytest.raises(UsageError, match="did you mean 'guard'"):
        new("gard", "x", tmp_path)


@pytest.mark.parametrize("files", [guard_files("a_b"), behavior_files("a_b")])
def test_generated_code_is_formatted_as_ours(files):
    for path, text in files.items():
        assert max(map(len, text.splitlines())) <= 100, path
        assert text.endswith("\n")
        assert "${" not in text
        if path.endswith(".py"):
            ast.parse(text)
