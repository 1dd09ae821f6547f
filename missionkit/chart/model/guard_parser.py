"""From `when:` as a mission file writes it to a guard expression."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationError
from pydantic_core import CoreSchema, InitErrorDetails, core_schema

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.model_base import MissionPart, Scope
from missionkit.chart.model.plugin_references import needs_parameters, resolve
from missionkit.chart.model.validation_problems import error_details, relocated
from missionkit.chart.model.variables import is_number
from missionkit.chart.text.located_data import (
    LocatedList,
    LocatedTable,
    place_of,
    shown,
)
from missionkit.chart.text.mistake import (
    Path,
    carried,
    sentence,
    sentences,
)
from missionkit.units import Number

GUARD_FORMS = ("use", "all", "any", "not", "hysteresis", "variable", "in")


class ConditionField:
    """Marks a field that holds a guard expression."""

    says = "a guard"

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Parse the expression."""

        def validate(data: object, info: core_schema.ValidationInfo[Any]) -> ex.Expression:
            return parse(data, info.context)

        return core_schema.with_info_plain_validator_function(validate)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Leave a mark for `json_schema.mission_schema`: the catalogue is not known here."""
        return {"x-plugin": "guards"}


Condition = Annotated[ex.Expression, ConditionField]


class _Thresholds(MissionPart):
    hysteresis: Any
    enter: Number
    exit: Number


def parse(data: object, scope: Scope) -> ex.Expression:
    """Return the guard expression that a mission file writes.

    Raises:
        ValidationError: every mistake in it, in sentences, with paths below `data`.
    """
    if isinstance(data, str):
        return _word(data, scope)
    if not isinstance(data, LocatedTable):
        raise sentences(sentence(f"expected a guard, got {shown(data)}"))
    forms = [form for form in GUARD_FORMS if form in data]
    if len(forms) != 1:
        got = ", ".join(forms or data) or "nothing"
        raise sentences(sentence(f"expected one of {', '.join(GUARD_FORMS)}, got {got}"))
    match forms[0]:
        case "use":
            return resolve(data, "guards", scope)
        case "hysteresis":
            return _hysteresis(data, scope)
        case "variable":
            return _variable(data, scope)
        case "in":
            return _in(data, scope)
        case form:
            return _combined(form, data, scope)


def _word(word: str, scope: Scope) -> ex.Expression:
    place = place_of(word)
    if word in scope.guards:
        return ex.Named(word, place)
    kinds = scope.catalogue.group("guards")
    if word not in kinds and (why := scope.catalogue.broken.get(("guards", word))):
        raise sentences(sentence(f"guard {word!r} cannot be used: {why}"))
    if word not in kinds:
        bare = {kind for kind, plugin in kinds.items() if not needs_parameters(plugin)}
        raise sentences(sentence(f"unknown guard {word!r}", word=word, known=scope.guards | bare))
    if needs_parameters(kinds[word]):
        raise sentences(sentence(f"guard {word!r} needs parameters: {{use: {word}, ...}}"))
    return resolve(word, "guards", scope)


def _combined(form: str, data: LocatedTable, scope: Scope) -> ex.Expression:
    errors = [
        sentence(f"unknown key {key!r} beside {form!r}", key, at_key=True)
        for key in data
        if key != form
    ]
    inner = data[form]
    if form == "not":
        parts = _parsed([((form,), inner)], scope, errors)
    elif isinstance(inner, LocatedList) and inner:
        parts = _parsed([((form, at), item) for at, item in enumerate(inner)], scope, errors)
    else:
        message = f"{form!r}: expected a list of guards, got {shown(inner)}"
        raise sentences(*errors, sentence(message, form))
    if errors:
        raise sentences(*errors)
    if form == "not":
        return ex.Not(parts[0], data.place)
    return (ex.All if form == "all" else ex.Any)(parts, data.place)


def _hysteresis(data: LocatedTable, scope: Scope) -> ex.Expression:
    errors: list[InitErrorDetails] = []
    parts = _parsed([(("hysteresis",), data["hysteresis"])], scope, errors)
    if parts and not isinstance(parts[0], ex.Use | ex.Named):
        message = "expected one guard with a value, not a combination"
        errors.append(sentence(message, "hysteresis"))
    try:
        limits = _Thresholds.model_validate(data)
    except ValidationError as error:
        found = [carried(what, path) for path, what in error_details(error, _Thresholds, data)]
        raise sentences(*errors, *found) from error
    if limits.enter == limits.exit:
        errors.append(sentence("'enter' and 'exit' must differ", "exit"))
    if errors:
        raise sentences(*errors)
    return ex.Hysteresis(parts[0], limits.enter, limits.exit, data.place)


def _variable(data: LocatedTable, scope: Scope) -> ex.Expression:
    name, ops = data["variable"], [key for key in data if key in ex.COMPARISONS]
    if not isinstance(name, str) or name not in scope.variables:
        unknown = f"unknown variable {shown(name)}"
        raise sentences(sentence(unknown, "variable", word=str(name), known=scope.variables))
    if len(data) != 2 or len(ops) != 1:
        given = ", ".join(key for key in data if key != "variable") or "nothing"
        expected = f"expected one of {', '.join(ex.COMPARISONS)} beside 'variable', got {given}"
        raise sentences(sentence(expected))
    op, value = ops[0], data[ops[0]]
    if not isinstance(value, bool | int | float | str) or (op != "equals" and not is_number(value)):
        wanted = "a value" if op == "equals" else "a number"
        raise sentences(sentence(f"{op!r}: expected {wanted}, got {shown(value)}", op))
    return ex.VariableGuard(name, op, value, data.place)


def _in(data: LocatedTable, scope: Scope) -> ex.Expression:
    errors = [
        sentence(f"unknown key {key!r} beside 'in'", key, at_key=True)
        for key in data
        if key != "in"
    ]
    name = data["in"]
    if not isinstance(name, str) or name not in scope.states:
        unknown = f"unknown state {shown(name)}"
        errors.append(sentence(unknown, "in", word=str(name), known=scope.states))
    if errors:
        raise sentences(*errors)
    return ex.In(name, data.place)


def _parsed(
    items: Iterable[tuple[Path, object]], scope: Scope, errors: list[InitErrorDetails]
) -> tuple[ex.Expression, ...]:
    parts = []
    for path, item in items:
        try:
            parts.append(parse(item, scope))
        except ValidationError as error:
            errors += relocated(error, path)
    return tuple(parts)
