"""Actions: what the chart does on entry, on exit and on a transition (P1, section 1.2: λ)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from missionkit.chart.located import Table, shown
from missionkit.chart.sentence import sentence, sentences
from missionkit.errors import Place


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


_ACTIONS: dict[str, type[Log | Raise]] = {"log": Log, "raise": Raise}


class ActionField:
    """Marks a field that holds one action: `{log: text}` or `{raise: event}`."""

    says = "an action"

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Parse the action."""
        return core_schema.no_info_plain_validator_function(_parse)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return one alternative for each action."""
        return {"oneOf": [_schema(key, kind) for key, kind in _ACTIONS.items()]}


Action = Annotated[Log | Raise, ActionField]


def _parse(data: object) -> Log | Raise:
    if not isinstance(data, Table) or len(data) != 1:
        one_of = " or ".join(f"{{{key}: ...}}" for key in _ACTIONS)
        raise sentences(sentence(f"expected one action, {one_of}, got {shown(data)}"))
    ((key, value),) = data.items()
    if key not in _ACTIONS:
        unknown = sentence(f"unknown action {key!r}", key, word=key, known=_ACTIONS, at_key=True)
        raise sentences(unknown)
    if not isinstance(value, str) or not value:
        raise sentences(sentence(f"{key!r}: expected a text, got {shown(value)}", key))
    return _ACTIONS[key](value, data.place)


def _schema(key: str, kind: type[Log | Raise]) -> dict[str, Any]:
    return {
        "type": "object",
        "description": kind.__doc__,
        "properties": {key: {"type": "string", "minLength": 1}},
        "required": [key],
        "additionalProperties": False,
    }
