"""Actions: what the chart does on entry, on exit and on a transition (P1, section 1.2: λ)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from missionkit.chart.model.model_base import Scope
from missionkit.chart.model.variables import Value
from missionkit.chart.text.located_data import LocatedTable, shown
from missionkit.chart.text.mistake import sentence, sentences
from missionkit.errors import Place

VEHICLE_ORDERS = ("arm", "disarm", "hold", "land", "return")
OPERATIONS = ("set", "add", "copy", "toggle")


@dataclass(frozen=True, slots=True)
class Log:
    """Write a line into the flight record."""

    text: str
    place: Place


@dataclass(frozen=True, slots=True)
class Raise:
    """Send an event to the chart itself."""

    event: str
    place: Place


@dataclass(frozen=True, slots=True)
class Assign:
    """Give a variable a value: itself, `{add: n}`, `{copy: variable}` or `{toggle: true}`."""

    variable: str
    operation: str  # one of OPERATIONS
    operand: Value
    place: Place


@dataclass(frozen=True, slots=True)
class Order:
    """Ask the autopilot for something: arm, disarm, hold, land, return."""

    action: str
    place: Place


Act = Log | Raise | Assign | Order


class ActionField:
    """Marks a field that holds one action, such as `{log: text}` or `{assign: {tries: 0}}`."""

    says = "an action"

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Parse the action."""

        def validate(data: object, info: core_schema.ValidationInfo[Any]) -> Act:
            return _parse(data, info.context)

        return core_schema.with_info_plain_validator_function(validate)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return one alternative for each action."""
        text = {"type": "string", "minLength": 1}
        operation = {"properties": {key: {} for key in OPERATIONS}, "additionalProperties": False}
        scalar = {"type": ["string", "number", "boolean"]}
        value = {"anyOf": [scalar, {"type": "object", "minProperties": 1, **operation}]}
        assign = {"type": "object", "minProperties": 1, "maxProperties": 1}
        forms: dict[str, tuple[type, dict[str, Any]]] = {
            "log": (Log, text),
            "raise": (Raise, text),
            "assign": (Assign, {**assign, "additionalProperties": value}),
            "vehicle": (Order, {"enum": list(VEHICLE_ORDERS)}),
        }
        return {"oneOf": [_schema(key, kind, form) for key, (kind, form) in forms.items()]}


Action = Annotated[Act, ActionField]


def _parse(data: object, scope: Scope) -> Act:
    if not isinstance(data, LocatedTable) or len(data) != 1:
        one_of = " or ".join(f"{{{key}: ...}}" for key in _PARSERS)
        raise sentences(sentence(f"expected one action, {one_of}, got {shown(data)}"))
    ((key, value),) = data.items()
    if key not in _PARSERS:
        unknown = sentence(f"unknown action {key!r}", key, word=key, known=_PARSERS, at_key=True)
        raise sentences(unknown)
    return _PARSERS[key](value, data, scope)


def _text(key: str, value: object) -> str:
    if not isinstance(value, str) or not value:
        raise sentences(sentence(f"{key!r}: expected a string, got {shown(value)}", key))
    return value


def _log(value: object, data: LocatedTable, _: Scope) -> Log:
    return Log(_text("log", value), data.place)


def _raise(value: object, data: LocatedTable, _: Scope) -> Raise:
    return Raise(_text("raise", value), data.place)


def _order(value: object, data: LocatedTable, _: Scope) -> Order:
    word = _text("vehicle", value)
    if word not in VEHICLE_ORDERS:
        unknown = f"unknown action of the vehicle {word!r}"
        raise sentences(sentence(unknown, "vehicle", word=word, known=VEHICLE_ORDERS))
    return Order(word, data.place)


def _assign(value: object, data: LocatedTable, scope: Scope) -> Assign:
    if not isinstance(value, LocatedTable) or len(value) != 1:
        expected = f"'assign': expected one {{variable: value}}, got {shown(value)}"
        raise sentences(sentence(expected, "assign"))
    ((name, wanted),) = value.items()
    if name not in scope.variables:
        unknown = f"unknown variable {name!r}"
        at = ("assign", name)
        raise sentences(sentence(unknown, *at, word=name, known=scope.variables, at_key=True))
    operation, operand = "set", wanted
    if isinstance(wanted, LocatedTable) and len(wanted) == 1:
        ((operation, operand),) = wanted.items()
    if operation not in OPERATIONS or not isinstance(operand, bool | int | float | str):
        expected = f"expected a value or one of {', '.join(OPERATIONS)}, got {shown(wanted)}"
        raise sentences(sentence(expected, "assign", name))
    if operation == "copy" and operand not in scope.variables:
        unknown = f"unknown variable {operand!r}"
        path = ("assign", name, "copy")
        raise sentences(sentence(unknown, *path, word=str(operand), known=scope.variables))
    return Assign(name, operation, operand, data.place)


_PARSERS: dict[str, Callable[[object, LocatedTable, Scope], Act]] = {
    "log": _log,
    "raise": _raise,
    "assign": _assign,
    "vehicle": _order,
}


def _schema(key: str, kind: type, form: dict[str, Any]) -> dict[str, Any]:
    return {
        "type": "object",
        "description": kind.__doc__,
        "properties": {key: form},
        "required": [key],
        "additionalProperties": False,
    }
