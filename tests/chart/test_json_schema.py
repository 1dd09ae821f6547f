"""The committed schemas are those of the models, and fit the missions.

After a change: `make schema`.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from pydantic import BaseModel

from missionkit.chart.model.json_schema import dumps, mission_schema, model_schema
from missionkit.chart.model.key_descriptions import DESCRIPTIONS
from missionkit.chart.model.mission_names import names_in
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.text.yaml_reader import read, read_file
from missionkit.sim.free_flyer.world import FreeFlyerWorld
from missionkit.sim.world import World

ROOT = Path(__file__).parents[2]
MISSIONS = sorted((ROOT / "missions").glob("*.yaml"))
WORLDS = sorted((ROOT / "missions" / "worlds").glob("*.yaml"))
REFUSED_BY_SCHEMA = (
    "01-misspelt-key",
    "02-unknown-state-kind",
    "03-unknown-guard-plugin",
    "04-unknown-guard-parameter",
    "05-wrong-type",
    "06-out-of-range",
    "07-missing-to",
    "17-state-not-mapping",
    "19-unknown-dictionary",
    "20-version-2",
    "23-list-for-mapping",
    "29-missing-sections",
    "31-vector-too-short",
    "32-two-forms-of-guard",
    "33-behavior-missing",
    "36-unknown-action",
)


def validator(name: str) -> Any:
    schema = json.loads((ROOT / "schemas" / name).read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.fixture(scope="module")
def missions() -> Any:
    return validator("mission.schema.json")


def test_the_mission_schema_has_not_drifted(catalogue: Catalogue):
    committed = (ROOT / "schemas" / "mission.schema.json").read_text()
    assert committed == dumps(mission_schema(catalogue))


@pytest.mark.parametrize("model", [World, FreeFlyerWorld])
def test_the_schemas_of_worlds_have_not_drifted(model: type[BaseModel]):
    name = "world" if model is World else "free_flyer_world"
    committed = (ROOT / "schemas" / f"{name}.schema.json").read_text()
    assert committed == dumps(model_schema(model))


@pytest.mark.parametrize("path", MISSIONS, ids=lambda path: path.stem)
def test_missions_fit(path: Path, missions: Any):
    missions.validate(read_file(path).data)


@pytest.mark.parametrize("path", WORLDS, ids=lambda path: path.stem)
def test_worlds_fit_their_vehicle_s_schema(path: Path):
    data = read_file(path).data
    fits, other = "world.schema.json", "free_flyer_world.schema.json"
    if "vehicle" in data:
        fits, other = other, fits
    validator(fits).validate(data)
    assert not validator(other).is_valid(data)


@pytest.mark.parametrize("name", REFUSED_BY_SCHEMA)
def test_editors_see_mistakes(name: str, missions: Any):
    path = ROOT / "tests" / "broken" / f"{name}.yaml"
    assert not missions.is_valid(read_file(path).data)


def test_parameters_may_stand_for_values(missions: Any, example: Path):
    text = example.read_text().replace("after: 120", "after: $patience")
    missions.validate(read(text, "m.yaml").data)
    assert not missions.is_valid(read(text.replace("$patience", "patience"), "m.yaml").data)


def test_units_are_described(catalogue: Catalogue):
    radius = mission_schema(catalogue)["$defs"]["guards.within"]["properties"]["radius"]
    assert radius["unit"] == "m"
    assert radius["description"] == "m"


def undescribed(node: Any, path: str = "") -> list[str]:
    """Return the keys of a schema that say nothing of themselves; a constant says all it is."""
    if isinstance(node, list):
        return [key for item in node for key in undescribed(item, path)]
    if not isinstance(node, dict):
        return []
    own = [
        f"{path}.{key}"
        for key, value in node.get("properties", {}).items()
        if isinstance(value, dict) and "description" not in value and "const" not in value
    ]
    inner = {key: value for key, value in node.items() if key != "if"}
    return own + [it for key, value in inner.items() for it in undescribed(value, f"{path}/{key}")]


def test_every_key_has_a_description(catalogue: Catalogue):
    assert undescribed(mission_schema(catalogue)) == []
    assert undescribed(model_schema(World)) == []
    assert undescribed(model_schema(FreeFlyerWorld)) == []


def test_no_description_is_left_over(catalogue: Catalogue):
    schemas = (mission_schema(catalogue), model_schema(World), model_schema(FreeFlyerWorld))
    definitions = {name for schema in schemas for name in schema["$defs"]}
    definitions |= {"Mission", "World", "FreeFlyerWorld"}
    lost = [key for key in DESCRIPTIONS if "." in key and key.rpartition(".")[0] not in definitions]
    assert lost == []


def test_the_names_of_one_mission_are_completed(catalogue: Catalogue, tmp_path: Path):
    path = tmp_path / "mission.yaml"
    path.write_text((ROOT / "missions" / "precision_task.yaml").read_text() + "\nwrong: 1\n")
    names = names_in(path, catalogue)
    whole = mission_schema(catalogue, names)
    jsonschema.Draft202012Validator.check_schema(whole)
    check = jsonschema.Draft202012Validator(whole)
    data = read_file(ROOT / "missions" / "precision_task.yaml").data
    check.validate(data)
    assert "x-name" not in dumps(whole)
    assert not check.is_valid({**data, "initial": "nowhere"})
    goal = whole["$defs"]["behaviors.go_to"]["properties"]["target"]["anyOf"][0]
    assert goal["enum"] == sorted(names["target"])
    assert {"home", *data["targets"]} == set(goal["enum"])
