"""The documents agree with the program."""

from __future__ import annotations

import inspect
import re
import shlex
from typing import get_args

import pytest
import typer
import yaml
from documents import DOCS, ROOT, as_mission, blocks, defaults, document, plugin_files, table
from typer.testing import CliRunner

from missionkit.chart.checks import findings
from missionkit.chart.load import parse
from missionkit.chart.model import mission as model
from missionkit.chart.model import state_definitions
from missionkit.chart.model.field_descriptions import keys_of
from missionkit.chart.model.state_contracts import unmet
from missionkit.chart.model.state_definitions import GROUP_KIND
from missionkit.chart.model_file import load_model
from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.plugin_groups import PLUGIN_GROUPS
from missionkit.cli.app import app
from missionkit.control.controller import Control
from missionkit.control.pid import Gains
from missionkit.control.velocity_limits import Limits
from missionkit.control.yaw_law import YawLaw
from missionkit.guards.estimated_chain import EstimatedChain
from missionkit.perception.aruco import Aruco
from missionkit.perception.camera_section import Camera, Mount
from missionkit.planning.map_section import KnownMap, Weight
from missionkit.planning.map_server import MapFile
from missionkit.recorder.topic_schemas import TOPICS
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import stage
from missionkit.sim import arena, vehicle_parameters, world
from missionkit.sim.fault_injection import FAULT_KINDS as FAULTS
from missionkit.sim.fault_injection import FREE_FLYER_KINDS
from missionkit.sim.free_flyer import body_model
from missionkit.sim.free_flyer import world as flyer_world
from missionkit.sim.free_flyer.world import FreeFlyerWorld
from missionkit.sim.world import World

MISSION = document("docs/reference/mission-file.md")
PLUGINS = document("docs/reference/plugins.md")
RECORD = document("docs/how-to/read-a-flight-record.md")
SIMULATOR = document("docs/reference/simulator.md")


@pytest.mark.parametrize("text", blocks("yaml"))
def test_every_example_is_valid(text, tmp_path):
    keys = yaml.safe_load(text)
    if "world" in keys and "mission" not in keys:
        path = tmp_path / "world.yaml"
        path.write_text(text)
        assert load_model(path, FreeFlyerWorld if "vehicle" in keys else World).world
        return
    if "chain" in keys:
        path = tmp_path / "chain.yaml"
        path.write_text(text)
        assert load_model(path, EstimatedChain).flights
        return
    if "chain: chain.yaml" in text:
        (chain,) = [it.values[0] for it in blocks("yaml") if it.values[0].startswith("chain:")]
        (tmp_path / "chain.yaml").write_text(chain)
    catalogue = builtin()
    if "too_fast" in text:  # the guard that `missionkit new` writes
        CliRunner().invoke(app, ["new", "guard", "too_fast", "--to", str(tmp_path)])
        catalogue = catalogue.with_file(next(tmp_path.rglob("missionkit_too_fast.py")))
    elif "circle" in text:  # the behaviour of docs/how-to/write-a-behavior.md
        for path in plugin_files(tmp_path):
            catalogue = catalogue.with_file(path)
    mission = parse(as_mission(text), str(tmp_path / "example"), catalogue)
    assert unmet(mission, catalogue) == []


def test_the_smallest_mission_of_the_read_me_flies():
    (example,) = [it.values[0] for it in blocks("yaml") if it.id.startswith("README.md")]
    catalogue = builtin()
    mission = parse(example, "README.md", catalogue)
    assert findings(mission, catalogue) == []
    flight = stage(mission, catalogue, World(world="empty"), 0)
    places = []
    result = rehearse(flight, (lambda *_: places.append(flight.vehicle.truth.position),))
    assert result.succeeded
    assert max(north for north, _, _ in places) == pytest.approx(40.0, abs=2.0)
    assert min(-down for north, _, down in places if north > 5.0) > 3.0


@pytest.mark.parametrize("text", blocks("sh"))
def test_every_command_is_understood(text):
    commands = typer.main.get_command(app).commands
    for line in text.splitlines():
        program, *words = shlex.split(line, comments=True) or [""]
        if program == "missionkit":
            commands[words[0]].make_context(words[0], words[1:])
        elif program == "make":
            assert re.search(rf"^{words[0]}:", document("Makefile"), re.MULTILINE)


@pytest.mark.parametrize("path", DOCS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(path):
    links = re.findall(r"\]\((?!https?://|#)([^)#]+)", path.read_text())
    assert [link for link in links if not (path.parent / link).exists()] == []


def test_the_map_of_the_package_names_files_that_exist():
    named = re.findall(r"`([\w/]+\.py)`", document("CONTRIBUTING.md"))
    assert named
    assert [name for name in named if not (ROOT / "missionkit" / name).is_file()] == []


@pytest.mark.parametrize(
    ("text", "heading", "part"),
    [
        (MISSION, "The whole file", model.Mission),
        (MISSION, "Camera", Camera),
        (MISSION, "Map", KnownMap),
        (MISSION, "States", state_definitions.State),
        (MISSION, "Transitions", state_definitions.Transition),
        (MISSION, "Failsafes", state_definitions.Failsafe),
        (MISSION, "Success", model.Success),
        (SIMULATOR, "The world file", World),
        (SIMULATOR, "Wind", world.Wind),
        (SIMULATOR, "Markers", world.Marker),
        (SIMULATOR, "Arena", arena.Arena),
        (SIMULATOR, "Target robots", arena.Robots),
        (SIMULATOR, "Obstacle robots", arena.ObstacleRobots),
        (SIMULATOR, "Airframe", vehicle_parameters.Quadrotor),
        (SIMULATOR, "Autopilot", vehicle_parameters.InnerAutopilotModel),
        (SIMULATOR, "Battery", vehicle_parameters.BatteryModel),
        (SIMULATOR, "World of a free flyer", flyer_world.FreeFlyerWorld),
        (SIMULATOR, "Docking target", flyer_world.DockingTarget),
        (SIMULATOR, "Start of a free flyer", flyer_world.FlyerStart),
        (SIMULATOR, "Docking corridor", flyer_world.CorridorModel),
        (SIMULATOR, "Capture", flyer_world.Capture),
        (SIMULATOR, "Body of a free flyer", body_model.FreeFlyerBody),
    ],
)
def test_a_table_has_every_key_and_its_default(text, heading, part):
    documented = [(row[0].strip("`"), row[1]) for row in table(text, heading)]
    assert dict(documented) == dict(defaults(part.model_fields))


def model_of(annotation):
    """Return the model of a section, of one that may be absent too."""
    return next(it for it in get_args(annotation) or (annotation,) if it is not type(None))


@pytest.mark.parametrize(
    ("heading", "sensors"),
    [
        ("Sensors", vehicle_parameters.Sensors),
        ("Sensors of a free flyer", body_model.FlyerSensors),
    ],
)
def test_the_tables_of_sensors_are_complete(heading, sensors):
    documented = [(row[0].strip("`"), row[1]) for row in table(SIMULATOR, heading)]
    assert documented == [
        (f"{sensor}.{key}", default)
        for sensor, it in sensors.model_fields.items()
        for key, default in defaults(model_of(it.annotation).model_fields)
    ]


@pytest.mark.parametrize(
    "part",
    [
        *(model.TargetPlace, state_definitions.Invariant, model.Settings, Aruco, Mount),
        *(Control, Gains, YawLaw, Limits, MapFile, Weight),
    ],
)
def test_keys_without_a_table_are_documented_too(part):
    assert [key for key in keys_of(part) if not re.search(rf"`{key}`|\b{key}:", MISSION)] == []


@pytest.mark.parametrize("kind", builtin().kinds.values(), ids=lambda kind: kind.name)
def test_the_table_of_kinds_shows_their_contracts(kind):
    rows = {row[0].strip("`"): row[1:] for row in table(MISSION, "Kinds of state")}
    mode, behavior, reach, holds, added = rows[kind.name]
    needed = "—" if kind.name == GROUP_KIND else "required"
    assert (mode, behavior) == (str(kind.mode), kind.default_behavior or needed)
    assert reach == (", ".join(kind.must_reach) or "—")
    due = kind.invariant
    assert holds.endswith(f"({due.tolerated:g} s → {due.to_kind})" if due else "—")
    assert added == (", ".join(f"{it.use} → {it.to_kind}" for it in kind.failsafes) or "—")


@pytest.mark.parametrize("group", PLUGIN_GROUPS)
def test_every_plugin_has_its_row(group):
    wanted = []
    for kind, plugin in sorted(builtin().group(group).items()):
        given = [f"`{key}` {default}" for key, default in defaults(plugin.model_fields)]
        parameters = ", ".join(given).replace(" required", "") or "—"
        if group in {"navigators", "trackers", "planners", "controllers"}:
            parameters = "many"
        summary = (inspect.getdoc(plugin) or "").partition("\n")[0]
        wanted.append([f"`{kind}`", parameters, summary])
    heading = "Behaviours" if group == "behaviors" else group.capitalize().replace("_", " ")
    assert table(PLUGINS, heading) == wanted


def test_every_contract_has_its_row():
    wanted = []
    for name, group in PLUGIN_GROUPS.items():
        for contract in group.contracts:
            members = {
                key: ", ".join([*inspect.signature(it).parameters][1:])
                for key, it in vars(contract).items()
                if inspect.isfunction(it) and not key.startswith("_")
            }
            fields = [f"`{key}`" for key, it in vars(contract).items() if isinstance(it, property)]
            calls = [f"`{key}({arguments})`" for key, arguments in members.items()]
            wanted.append((f"`{name}`", ", ".join([*fields, *calls])))
    assert [tuple(row[:2]) for row in table(PLUGINS, "Contracts")] == wanted


@pytest.mark.parametrize(
    ("heading", "faults"), [("Faults", FAULTS), ("Faults of a free flyer", FREE_FLYER_KINDS)]
)
def test_every_fault_has_its_row(heading, faults):
    units = {name: "" if it.unit == "1" else f" {it.unit}" for name, it in faults.items()}
    assert table(SIMULATOR, heading) == [
        [f"`{name}`", "—" if it.value is None else f"{it.value:g}{units[name]}", it.effect]
        for name, it in faults.items()
    ]


def test_every_topic_of_the_record_has_its_row():
    documented = {row[0].strip("`") for row in table(RECORD, "Topics")}
    assert documented == {topic.name for topic in TOPICS}
