from __future__ import annotations

import json
import sys
from importlib.metadata import EntryPoint, EntryPoints

import pytest

from missionkit import __version__, cli
from missionkit.chart import plugin_catalogue
from missionkit.chart.plugin_catalogue import builtin
from missionkit.sim.fault_injection import FAULT_KINDS as FAULTS
from missionkit.sim.fault_injection import FREE_FLYER_KINDS


def test_without_arguments_the_help_is_shown(call):
    result = call()
    assert result.exit_code == 2
    for word in ("run", "validate", "plugins", "schema", "graph", "new", "Exit codes:"):
        assert word in result.output


def test_the_version(call):
    result = call("--version")
    assert (result.exit_code, result.stdout) == (0, f"{__version__}\n")


def test_a_good_mission_is_called_so(call):
    result = call("validate", "hop.yaml")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == "hop.yaml: ok (2 states, 0 guards, 0 failsafes)\n"
    result = call("validate", "hop.yaml", "--json")
    assert json.loads(result.stdout) == []


def test_a_broken_mission_is_explained_on_stderr(call, hop):
    hop.write_text(hop.read_text().replace("kind: idle", "kind: idel"))
    message = "state 'idle': unknown kind of state 'idel'; did you mean 'idle'? Known: "
    result = call("validate", "hop.yaml")
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith(f"hop.yaml:8:11: error: {message}")
    result = call("validate", "hop.yaml", "--json")
    assert (result.exit_code, result.stderr) == (2, "")
    (problem,) = json.loads(result.stdout)
    assert (problem["file"], problem["line"], problem["column"]) == ("hop.yaml", 8, 11)
    assert problem["message"].startswith(message)


@pytest.mark.parametrize(
    ("world", "says"),
    [
        ("bda.yaml", "hop.yaml:13:8: world 'bda.yaml': no such file beside the mission; did you "),
        ("bad.yaml", "bad.yaml:3:3: 'obstacles', item 1: 'cylindr' is unknown; did you mean"),
    ],
)
@pytest.mark.parametrize("command", ["validate", "run"])
def test_an_unusable_world_is_reported(call, hop, command, world, says):
    (hop.parent / "bad.yaml").write_text("world: bad\nobstacles:\n- {use: cylindr}\n")
    hop.write_text(f"{hop.read_text()}world: {world}\n")
    result = call(command, "hop.yaml")
    assert result.exit_code == 2
    assert result.stderr.replace(": error: ", ": ").startswith(says)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["run"], "name the mission file to fly, or --resume RUN"),
        (["rn", "hop.yaml"], "did you mean 'run'?"),
        (["run", "hop.yaml", "--sed", "3"], "--seed"),
        (["run", "hop.yaml", "--seed", "-1"], "missionkit run: --seed: expected"),
        (["run", "hop.yaml", "--seed", "many"], "missionkit run: --seed: expected"),
        (["run", "hop.yaml", "--speed", "0"], "missionkit run: --speed: expected"),
        (["run", "hop.yaml", "--speed", "nan"], "missionkit run: --speed: expected"),
        (["run", "hpo.yaml"], "hpo.yaml:1:1: cannot be read: no such file"),
        (["run", "."], ".:1:1: cannot be read: it is a folder, not a file"),
        (["run", "bytes.yaml"], "bytes.yaml:1:1: not UTF-8 text"),
        (["run", "list.yaml"], "list.yaml:1:1: expected a mapping"),
        (["run", "hop.yaml", "--out", "hop.yaml"], "hop.yaml: this is a file, where a folder"),
        (["run", "hop.yaml", "--set", "height"], "--set height: expected NAME=VALUE"),
        (["run", "hop.yaml", "--set", "hight=3"], "did you mean 'height'"),
        (["run", "hop.yaml", "--set", "height=high"], "expected a number (m), got 'high'"),
        (["run", "hop.yaml", "--set", "height=-1"], "must be above 0 m, got -1"),
        (["run", "hop.yaml", "--fault", "gnss_lst"], "did you mean 'gnss_lost'"),
        (["run", "hop.yaml", "--fault", "gnss_lost@lnd"], "unknown state 'lnd'; did you mean"),
        (["run", "hop.yaml", "--fault", "marker_hidden=7"], "no such marker in world 'empty'"),
        (["run", "hop.yaml", "--plugin", "none.py"], "none.py:1:1: cannot be read: no such file"),
        (["run", "hop.yaml", "--plugin", "hop.yaml"], "hop.yaml:1:1: cannot be read: not a Python"),
        (
            ["validate", "hop.yaml", "--plugin", "syntax.py"],
            "syntax.py:2:5: error: cannot be imported",
        ),
        (
            ["validate", "hop.yaml", "--plugin", "name.py"],
            "name.py:3:5: error: cannot be imported: Name",
        ),
        (["validate", "hop.yaml", "--plugin", "empty.py"], "empty.py:1:1: error: no plug-in here"),
        (["plugins", "go_too"], "did you mean 'go_to'"),
        (["plugins", "gpss"], "did you mean 'gps'"),
        (["schema", "misson"], "did you mean 'mission'"),
        (["schema", "--write", "hop.yaml"], "hop.yaml: this is a file, where a folder"),
        (["graph", "hop.yaml", "--out", "hop.png"], "ends in .mmd or .svg"),
        (["graph", "hop.yaml", "--out", "none/hop.svg"], "none/hop.svg: No such file"),
        (["new", "guard", "x", "--to", "hop.yaml"], "this is a file, where a folder is expected"),
        (["fence", "hop.yaml", "udpin://0.0.0.0:14540"], "missionkit fence ADDRESS MISSION.yaml"),
        (["new", "gard", "x"], "did you mean 'guard'"),
        (["new", "guard", "Größe"], "use a-z, 0-9 and _"),
        (["new", "guard", "within"], "already a guard called 'within'"),
        (["new", "mission", "hop"], "hop.yaml already exists"),
    ],
)
def test_misuse_is_explained_and_leaves_nothing_behind(call, tmp_path, arguments, says):
    (tmp_path / "bytes.yaml").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "list.yaml").write_text("- 1\n")
    (tmp_path / "syntax.py").write_text("\nx = (\n")
    (tmp_path / "name.py").write_text("import math\n\nx = nothere\n")
    (tmp_path / "empty.py").write_text("x = 1\n")
    before = set(tmp_path.rglob("*"))
    result = call(*arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert says in result.stderr
    assert set(tmp_path.rglob("*")) == before


def test_every_plugin_kind_and_fault_is_listed(call):
    listed = call("plugins").stdout
    words = {line.split()[0] for line in listed.splitlines() if line.startswith("  ")}
    catalogue = builtin()
    for names in (*catalogue.plugins.values(), catalogue.kinds, FAULTS, FREE_FLYER_KINDS):
        assert words >= set(names)


def test_a_plugin_has_a_page(call):
    page = call("plugins", "converged").stdout
    assert "8.1: 0.1 m, 5 deg" in page
    (row,) = [line.split() for line in page.splitlines() if line.startswith("  yaw_deg")]
    assert row == ["yaw_deg", "number", "deg", "5.0"]
    both = call("plugins", "land").stdout
    assert "Let the autopilot land here" in both
    assert "(kind of state)" in both


def test_a_kind_of_state_shows_its_contract(call):
    page = call("plugins", "visual").stdout
    for line in ("must reach       search, land", "target_lost, longer_than 2 -> search"):
        assert line in page


def test_plugins_for_programs(call):
    everything = json.loads(call("plugins", "--json").stdout)
    assert set(everything) >= set(builtin().group("guards"))
    one = json.loads(call("plugins", "battery_below", "--json").stdout)
    (floor, _) = one["battery_below"]["parameters"]
    assert (floor["name"], floor["default"]) == ("floor", "required")


def test_schemas(call, tmp_path):
    assert json.loads(call("schema").stdout)["properties"]["missionkit"]
    assert json.loads(call("schema", "world").stdout)["properties"]["obstacles"]
    assert call("schema", "--write", "made").exit_code == 0
    names = {path.name for path in (tmp_path / "made").iterdir()}
    assert names == {f"{it}.schema.json" for it in ("mission", "world", "free_flyer_world")}


def test_charts_are_drawn(call, tmp_path):
    drawn = call("graph", "hop.yaml").stdout
    assert drawn.startswith("stateDiagram-v2")
    assert "s0_idle --> s1_land : done" in drawn
    assert call("graph", "hop.yaml", "--out", "hop.svg").stdout == "hop.svg\n"
    assert (tmp_path / "hop.svg").read_text().startswith("<svg")


def test_a_new_guard_can_be_used_at_once(call, hop):
    made = call("new", "guard", "too_fast").stdout.split()
    assert "missionkit-too-fast/missionkit_too_fast.py" in made
    hop.write_text(hop.read_text().replace("when: done", "when: too_fast"))
    assert "unknown guard 'too_fast'" in call("validate", "hop.yaml").stderr
    plugin = ["--plugin", "missionkit-too-fast/missionkit_too_fast.py"]
    assert call("validate", "hop.yaml", *plugin).exit_code == 0
    assert "too_fast" in call("plugins", *plugin).stdout


def test_a_mistake_of_ours_is_a_crash(monkeypatch, capsys):
    def broken() -> None:
        raise ZeroDivisionError("ours")

    monkeypatch.setattr(sys.modules["missionkit.cli.app"], "app", broken)
    with pytest.raises(SystemExit) as caught:
        cli.main()
    assert caught.value.code == 4
    assert "ZeroDivisionError: ours" in capsys.readouterr().err


def test_a_broken_package_is_listed_with_its_reason_and_breaks_nothing_else(call, monkeypatch):
    entries = EntryPoints([EntryPoint("mine", "nowhere.at_all:Mine", "missionkit.guards")])
    monkeypatch.setattr(plugin_catalogue, "entry_points", lambda: entries)
    assert call("validate", "hop.yaml").exit_code == 0
    listed = call("plugins")
    why = "nowhere.at_all:Mine cannot be imported: ModuleNotFoundError: No module named 'nowhere'"
    assert listed.exit_code == 0
    assert f"  {'mine':20} {why}" in listed.stdout
    page = call("plugins", "mine")
    assert (page.exit_code, page.stderr) == (2, f"plug-in 'mine' cannot be used: {why}\n")
    assert json.loads(call("plugins", "mine", "--json").stdout) == {"mine": {"broken": why}}
