"""JSON Schema (draft 2020-12) of the files, for editors and for programs that write missions.

Generated from the models and the catalogue, so it lists the parameters, units and manual pages
of every plug-in that is installed.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Mapping
from typing import Any

from pydantic import BaseModel

from missionkit.chart.model.guard_expressions import COMPARISONS
from missionkit.chart.model.key_descriptions import described
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.model_base import NAMES_KEY
from missionkit.chart.model.plugin_references import NO_PLUGIN, needs_parameters
from missionkit.chart.model.state_definitions import GROUP_KIND, SHAPE_KEYS
from missionkit.chart.plugin_catalogue import Catalogue, Plugins
from missionkit.chart.plugin_groups import PLUGIN_GROUPS
from missionkit.chart.text.parameter_expansion import PARAMETER_PATTERN

Schema = dict[str, Any]
Names = Mapping[str, Collection[str]]
NO_NAMES: Names = {}
DIALECT = "https://json-schema.org/draft/2020-12/schema"
_PARAMETER = "#/$defs/parameter"
_VARIABLE = "#/$defs/variable_value"
_META = ("description", "default", "unit")
_BY_NAME = frozenset({"properties", "patternProperties", "$defs"})
DEFAULTED = frozenset({"controllers"})  # groups whose `use` the kind of vehicle may say
_SCALARS = frozenset({"number", "integer", "boolean"})
_VARIED = _SCALARS | {"string"}


def mission_schema(catalogue: Catalogue, names: Names = NO_NAMES) -> Schema:
    """Return the schema of mission files that draw on `catalogue`.

    Args:
        catalogue: plug-ins and kinds of state that are installed.
        names: of one mission, by what they name ("state", "target", "guard"): its references are
            then limited to them, so that editors complete them.
    """
    schema = Mission.model_json_schema()
    definitions: Schema = schema.pop("$defs", {})
    for group in PLUGIN_GROUPS:
        for kind, plugin in sorted(catalogue.group(group).items()):
            used = plugin.model_json_schema()
            definitions |= used.pop("$defs", {})
            definitions[f"{group}.{kind}"] = _use(kind, used, needed=group not in DEFAULTED)
        definitions[group] = _any_plugin(group, catalogue.group(group))
    definitions["guards"] = _guard(definitions["guards"])
    definitions["State"] = _with_default_behavior(definitions["State"], catalogue)
    whole = {**schema, "$defs": definitions}
    finished: Schema = _mapped(whole, lambda node: _resolved(node, catalogue, names))
    finished["$defs"]["parameter"] = {
        "type": "string",
        "pattern": PARAMETER_PATTERN,
        "description": "$name: the value of a parameter",
    }
    finished["$defs"]["variable_value"] = _mapping(
        "the value that a variable has when the state is entered",
        {"variable": {"type": "string", "description": "its name"}},
    )
    for name, definition in finished["$defs"].items():
        if name.startswith("behaviors."):
            _allow_variables(definition)
    return {"$schema": DIALECT, **described(finished, Mission.__name__)}


def _allow_variables(behavior: Schema) -> None:
    """Let the numbers, words and truth values of a behaviour be given by variables."""
    for field in behavior.get("properties", {}).values():
        options = field.get("anyOf", ())
        scalar = any(it.get("type") in _VARIED or "enum" in it for it in options)
        if scalar and {"$ref": _PARAMETER} in options:
            field["anyOf"] = [*options, {"$ref": _VARIABLE}]


def model_schema(model: type[BaseModel]) -> Schema:
    """Return the schema of files that hold one `model` of plain values, such as worlds."""
    plain: Schema = _mapped(model.model_json_schema(), _plain)
    return {"$schema": DIALECT, **described(plain, model.__name__)}


def dumps(schema: Schema) -> str:
    """Return a schema as the text of its file."""
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


def _use(kind: str, schema: Schema, *, needed: bool) -> Schema:
    given = schema.get("properties", {}).items()
    fields = {key: _list_or_parameter(_target(key, it)) for key, it in given}
    properties = {"use": {"const": kind}, **fields}
    required = [*(["use"] if needed else []), *schema.get("required", [])]
    return {**schema, "properties": properties, "required": required}


def _target(key: str, field: Schema) -> Schema:
    """Mark a parameter that names a target."""
    named = key in {"target", "of"} and field.get("type") == "string"
    return {**field, NAMES_KEY: "target"} if named else field


def _list_or_parameter(field: Schema) -> Schema:
    """Let a list of values be `$name`; those of fixed length are seen to with all other values."""
    if field.get("type") != "array" or "prefixItems" in field:
        return field
    return _with_parameter(field)


def _any_plugin(group: str, plugins: Plugins) -> Schema:
    bare = sorted(kind for kind, plugin in plugins.items() if not needs_parameters(plugin))
    uses = [{"$ref": f"#/$defs/{group}.{kind}"} for kind in sorted(plugins)]
    words = [{"const": kind} for kind in bare]
    return {"description": f"a {PLUGIN_GROUPS[group].word}", "anyOf": [*words, *uses]}


def _with_default_behavior(state: Schema, catalogue: Catalogue) -> Schema:
    bare = (kind for kind, each in catalogue.kinds.items() if each.default_behavior is None)
    without = sorted(kind for kind in bare if kind != GROUP_KIND)
    include = {"type": "string", "description": "a file that says what the state is"}
    given = {"type": "object", "description": "values of the file's parameters"}
    listed = {"anyOf": [{"type": "array", "minItems": 1}, {"$ref": "#/$defs/parameter"}]}
    loop = {
        "type": "object",
        "description": "lists of what $name stands for, one copy of the state for each item",
        "minProperties": 1,
        "additionalProperties": listed,
    }
    retries = {"type": "integer", "minimum": 0, "description": "how often `to: retry` leads back"}
    return {
        **state,
        "properties": {
            **{"for_each": loop, "retries": retries, "include": include, "with": given},
            **state["properties"],
        },
        "required": [],
        "anyOf": [{"required": [key]} for key in ("include", "kind", *SHAPE_KEYS)],
        "if": {
            "required": ["kind"],
            "properties": {"kind": {"enum": without}, "states": False, "include": False},
        },
        "then": {"required": ["behavior"]},
    }


def _guard(plugins: Schema) -> Schema:
    guard = {"$ref": "#/$defs/guards"}
    several = {"type": "array", "items": guard, "minItems": 1}
    number = {"type": "number"}
    named = {
        "type": "string",
        NAMES_KEY: "guard",
        "description": "a guard of the section `guards:`",
    }
    forms = [
        _mapping("holds when all hold", {"all": several}),
        _mapping("holds when at least one holds", {"any": several}),
        _mapping("holds when the guard does not; unknown stays unknown", {"not": guard}),
        _mapping(
            "a latch on the guard's value",
            {"hysteresis": guard, "enter": number, "exit": number},
        ),
        _mapping("holds while a state is active", {"in": {"type": "string", NAMES_KEY: "state"}}),
        *(_comparison(word) for word in COMPARISONS),
    ]
    return {**plugins, "anyOf": [*plugins["anyOf"], named, *forms]}


def _comparison(word: str) -> Schema:
    value = {"type": ["number", "string", "boolean"] if word == "equals" else "number"}
    return _mapping("compares a variable", {"variable": {"type": "string"}, word: value})


def _mapping(description: str, properties: Schema) -> Schema:
    return {
        "type": "object",
        "description": description,
        "properties": properties,
        "required": list(properties),
        "additionalProperties": False,
    }


def _mapped(node: Any, change: Callable[[Schema], Schema]) -> Any:
    """Apply `change` to every schema inside a schema, innermost first."""
    if isinstance(node, list):
        return [_mapped(item, change) for item in node]
    if not isinstance(node, dict):
        return node
    inner = {}
    for key, value in node.items():
        if key in _BY_NAME and isinstance(value, dict):
            inner[key] = {name: _mapped(each, change) for name, each in value.items()}
        else:
            inner[key] = value if key in _META else _mapped(value, change)
    return change(inner)


def _plain(node: Schema) -> Schema:
    """Drop pydantic's titles, and say the unit where editors show it."""
    node = {key: value for key, value in node.items() if key != "title"}
    if "patternProperties" in node:
        node["additionalProperties"] = False
    unit, about = node.get("unit"), node.get("description")
    if unit in {None, "1"}:
        return node
    return {**node, "description": f"{about} ({unit})" if about else unit}


def _resolved(node: Schema, catalogue: Catalogue, names: Names) -> Schema:
    """Replace the marks that fields left, and allow `$name` for values."""
    if "x-plugin" in node:
        return _plugin_field(node)
    if "x-enum" in node:
        described = {kind: each.summary for kind, each in sorted(catalogue.kinds.items())}
        says = "; ".join(f"{kind}: {summary}" for kind, summary in described.items())
        return {"type": "string", "enum": list(described), "description": says}
    named = names.get(str(node.get(NAMES_KEY)), ())
    node = {key: value for key, value in node.items() if key != NAMES_KEY}
    return _or_parameter(_plain({**node, "enum": sorted(named)} if named else node))


def _plugin_field(node: Mapping[str, Any]) -> Schema:
    kept = {key: node[key] for key in _META if key in node}
    reference = {"$ref": f"#/$defs/{node['x-plugin']}"}
    if node.get("x-optional"):
        return {**kept, "anyOf": [{"const": NO_PLUGIN}, reference]}
    return {**kept, **reference}


def _or_parameter(node: Schema) -> Schema:
    kind = node.get("type")
    value = (isinstance(kind, str) and kind in _SCALARS) or "enum" in node or "prefixItems" in node
    if not value or "const" in node:
        return node
    return _with_parameter(node)


def _with_parameter(node: Schema) -> Schema:
    kept = {key: node[key] for key in _META if key in node}
    bare = {key: value for key, value in node.items() if key not in _META}
    return {**kept, "anyOf": [bare, {"$ref": _PARAMETER}]}
