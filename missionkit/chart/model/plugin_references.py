"""`use:`: from what a mission file writes to a plug-in with validated parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationError
from pydantic_core import CoreSchema, InitErrorDetails, core_schema

from missionkit.chart.model import variable_parameters
from missionkit.chart.model.field_descriptions import keys_of
from missionkit.chart.model.guard_expressions import Use
from missionkit.chart.model.model_base import HOME, Scope
from missionkit.chart.model.parameter_files import with_files
from missionkit.chart.model.validation_problems import plain
from missionkit.chart.plugin_groups import PLUGIN_GROUPS
from missionkit.chart.text.located_data import LocatedTable, place_of, shown
from missionkit.chart.text.mistake import sentence, sentences
from missionkit.guards.geofence import InsideFence
from missionkit.messages import names_a_track
from missionkit.plugin import InGroup, Plugin
from missionkit.plugin_containment import PluginError, is_foreign, reporting_faults
from missionkit.plugin_protocols import (
    BehaviorProtocol,
    CompositeGuardProtocol,
    NamedInput,
    WindowGuardProtocol,
)

NO_PLUGIN = "none"
BEHAVIORS = "behaviors"  # the group whose parameters variables may give


@dataclass(frozen=True, slots=True)
class PluginReference:
    """Marks a field that holds a plug-in of one group of the catalogue."""

    group: str
    optional: bool = False

    @property
    def says(self) -> str:
        """Description of a valid value, for messages."""
        return f"a {PLUGIN_GROUPS[self.group].word}, {{use: ...}}"

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Resolve the plug-in."""

        def validate(data: object, info: core_schema.ValidationInfo[Any]) -> Use[Plugin] | None:
            if self.optional and data == NO_PLUGIN:
                return None
            return resolve(data, self.group, info.context)

        return core_schema.with_info_plain_validator_function(validate)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Leave a mark for `json_schema.mission_schema`: the catalogue is not known here."""
        return {"x-plugin": self.group, "x-optional": self.optional}


def resolve(data: object, group: str, scope: Scope) -> Use[Plugin]:
    """Return the plug-in that `{use: kind, ...}`, or the bare kind, stands for.

    Args:
        data: a table with `use` and parameters, or the bare kind as text.
        group: key of `PLUGIN_GROUPS`, such as "guards".
        scope: names and plug-ins known to the document.

    Raises:
        ValidationError: it is none, or its parameters are wrong, in sentences.
    """
    word, known = PLUGIN_GROUPS[group].word, scope.catalogue.group(group)
    if not isinstance(data, dict):
        if not isinstance(data, str):
            raise sentences(sentence(f"expected a {word}, {{use: ...}}, got {shown(data)}"))
        data = LocatedTable(place_of(data)).extended("use", data, place_of(data))
    if "use" not in data:
        missing = f"missing key 'use': the kind of {word}"
        raise sentences(sentence(missing, word="", known=known))
    kind = data["use"]
    if (why := scope.catalogue.broken.get((group, str(kind)))) and str(kind) not in known:
        raise sentences(sentence(f"{word} {shown(kind)} cannot be used: {why}", "use"))
    if not isinstance(kind, str) or kind not in known:
        unknown = f"unknown {word} {shown(kind)}"
        raise sentences(sentence(unknown, "use", word=str(kind), known=known))
    given = with_files(known[kind], data, scope)
    inner = _inner_plugins(known[kind], given, scope)
    parameters = {key: value for key, value in given.items() if key not in {"use", *inner}}
    varied = variable_parameters.given_by(parameters, scope) if group == BEHAVIORS else {}
    parameters |= variable_parameters.first_values(varied, scope)
    try:
        plugin, errors = _made(known[kind], parameters, scope)
    except PluginError as error:
        wrong = f"{word} {shown(kind)} cannot be used: it raised {error}"
        raise sentences(sentence(wrong, "use")) from error
    if errors:
        raise sentences(*errors)
    plugin = plugin.model_copy(update=inner) if inner else plugin
    variable_parameters.try_bounds(plugin, varied, scope)
    return Use(kind, plugin, place_of(data), tuple(varied.items()))


def _inner_plugins(
    plugin: type[Plugin], data: Mapping[str, Any], scope: Scope
) -> dict[str, Plugin]:
    """Return the plug-ins that parameters name."""
    return {
        name: resolve(data[name], mark.group, scope).plugin
        for name, field in plugin.model_fields.items()
        for mark in field.metadata
        if isinstance(mark, InGroup) and name in data and data[name] not in mark.named
    }


def _made(
    plugin: type[Plugin], parameters: dict[str, Any], scope: Scope
) -> tuple[Plugin, list[InitErrorDetails]]:
    """Return a plug-in, and an error for each name it needs that does not exist."""
    if plugin is InsideFence and not parameters and scope.fence is not None:
        return scope.fence, []
    if not is_foreign(plugin):
        own = plain(plugin, parameters, scope)
        return own, unknown_targets(own, scope) + unknown_names(own, scope)
    with reporting_faults(ValidationError):
        made = plain(plugin, parameters, scope)
        if isinstance(made, WindowGuardProtocol | CompositeGuardProtocol):
            made.begin()  # the flight begins with it
        if isinstance(made, Plugin):
            made.text()
        return made, unknown_targets(made, scope) + unknown_names(made, scope)


def needs_parameters(plugin: type[Plugin]) -> bool:
    """Say whether a plug-in has parameters without a default."""
    return any(field.is_required() for field in plugin.model_fields.values())


def unknown_targets(plugin: Plugin, scope: Scope) -> list[InitErrorDetails]:
    """Return an error for each target that the mission does not define."""
    needed = plugin.targets() if isinstance(plugin, BehaviorProtocol) else (HOME,)
    known = scope.targets if HOME in needed else scope.targets | {HOME}
    keys = getattr(plugin, "target_keys", Plugin.target_keys)
    named = {key: getattr(plugin, key) for key in keys if key in keys_of(type(plugin))}
    errors = [
        _unknown_target(name, known, key)
        for key, name in named.items()
        if isinstance(name, str) and name not in known
    ]
    return errors + [
        _unknown_target(name, known, says="needs the unknown target")
        for name in needed
        if name not in known and name not in {HOME, *named.values()}
    ]


def _unknown_target(
    name: str, known: frozenset[str], *path: str, says: str = "unknown target"
) -> InitErrorDetails:
    if names_a_track(name):
        hint = "it is found in flight, which needs a section 'tracking: tracker'"
        return sentence(f"{says} {name!r}: {hint}", *path)
    return sentence(f"{says} {name!r}", *path, word=name, known=known)


def unknown_names(plugin: Plugin, scope: Scope) -> list[InitErrorDetails]:
    """Return an error for each name that a guard reads and the mission does not define."""
    if not isinstance(plugin, CompositeGuardProtocol):
        return []
    return [
        sentence(
            f"unknown {it.what} {it.name!r}",
            *it.path,
            word=it.name,
            known=_known(it, scope),
        )
        for it in plugin.named_inputs()
        if it.name not in _known(it, scope)
    ]


def _known(it: NamedInput, scope: Scope) -> frozenset[str]:
    match it.what:
        case "guard":
            return scope.guards
        case "variable":
            return scope.variables
        case "target":
            return scope.targets
        case "state":
            return scope.states
