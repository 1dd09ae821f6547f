"""Actions: what the chart does on entry, on exit and on a transition (P1, section 1.2: λ)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from missionkit.chart.model.model_base import Scope
from missionkit.chart.model.variables import Value, is_number
from missionkit.chart.text.located_data import LocatedTable, shown
from missionkit.chart.text.mistake import sentence, sentences
from missionkit.errors import Place

VEHICLE_ORDERS = ("arm", "disarm", "hold", "land", "return")
OPERATIONS = ("set", "add", "copy", "toggle")
RAISE_KEYS = ("event", "after")


@dataclass(frozen=True, slots=True)
class Log:
    """Write a line into the flight record."""

    text: str
    place: Place


@dataclass(frozen=True, slots=True)
class Raise:
    """Send an event to the chart itself, at once or later: `{event: name, after: 5}`."""

    event: str
    place: Place
    after: float | str | None = None  # s, or the variable that holds them


@dataclass(frozen=True, slots=True)
class Cancel:
    """Drop the delayed events of that name that are yet to come."""

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


Act = Log | Raise | Cancel | Assign | Order


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
        delayed = {
            "type": "object",
            "properties": {"event": text, "after": {"type": ["number", "string"], "minimum": 0}},
            "required": ["event"],
            "additionalProperties": False,
        }
        forms: dict[str, tuple[type, dict[str, Any]]] = {
            "log": (Log, text),
            "raise": (Raise, {"anyOf": [text, delayed]}),
            "cancel": (Cancel, text),
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


def _raise(value: object, data: LocatedTable, scope: Scope) -> Raise:
    if not isinstance(value, LocatedTable):
        return Raise(_text("raise", value), data.place)
    odd = next((key for key in value if key not in RAISE_KEYS), None)
    if odd is not None:
        unknown = f"unknown key {odd!r}"
        raise sentences(sentence(unknown, "raise", odd, word=odd, known=RAISE_KEYS, at_key=True))
    event = value.get("event")
    if not isinstance(event, str) or not event:
        expected = f"'event': expected a string, got {shown(event)}"
        raise sentences(sentence(expected, "raise", "event"))
    return Raise(event, data.place, _delay(value["after"], scope) if "after" in value else None)


def _delay(after: object, scope: Scope) -> float | str:
    at = ("raise", "after")
    if isinstance(after, str):
        if after not in scope.variables:
            unknown = f"unknown variable {after!r}"
            raise sentences(sentence(unknown, *at, word=after, known=scope.variables))
        return str(after)
    if not is_number(after):
        expected = f"'after': expected seconds or the name of a variable, got {shown(after)}"
        raise sentences(sentence(expected, *at))
    if after < 0.0:
        raise sentences(sentence(f"'after': expected 0 s or more, got {after:g}", *at))
    return float(after)


def _cancel(value: object, data: LocatedTable, _: Scope) -> Cancel:
    return Cancel(_text("cancel", value), data.place)


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
    "cancel": _cancel,
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
