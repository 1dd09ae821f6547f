"""Turns pydantic's errors into sentences: the error, the allowed values, the nearest name."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from missionkit.chart.model.field_descriptions import (
    BOUNDS,
    Path,
    expected,
    field_at,
    forms_in,
    keys_at,
    limits_of,
    unit_of,
)
from missionkit.chart.text.located_data import shown
from missionkit.chart.text.mistake import Mistake

_RANGE_ERRORS = frozenset(
    {"greater_than", "greater_than_equal", "less_than", "less_than_equal", "finite_number"}
)
_NO_SPACE = re.compile(r"\w+:\S")
_TYPE_ERRORS = ("_type", "_parsing", "_from_float")


def describe(error: Mapping[str, Any], model: type[BaseModel], path: Path) -> Mistake:
    """Return the sentence for one error of `ValidationError.errors()` on `model`.

    It names the key itself, but not the model's place in the document.

    Args:
        error: as pydantic gives it; its `loc` may name alternatives of a type.
        model: what was validated.
        path: the keys and indices that lead to the value in the data.
    """
    field = field_at(model, error["loc"])
    match error["type"]:
        case "value_error" | "assertion_error":
            return Mistake(_key(path) + str(error["msg"]).partition(", ")[2])
        case "missing":
            return Mistake(_missing(path, field))
        case "extra_forbidden":
            return _unknown_key(path, error["input"], keys_at(model, error["loc"][:-1]))
        case "literal_error" | "enum":
            return _unknown(path, error["input"], str(error["ctx"]["expected"]))
        case "union_tag_invalid":
            return _unknown(path, error["ctx"]["tag"], str(error["ctx"]["expected_tags"]))
        case _:
            return Mistake(_key(path) + _wrong_value(error, field))


def _unknown_key(path: Path, value: object, known: Collection[str]) -> Mistake:
    """Return the sentence for a key that is not known; a state that is not indented is named."""
    word = str(path[-1])
    if len(path) == 1 and isinstance(value, dict) and "kind" in value:
        return Mistake(f"unknown key {word!r}: a state is indented below 'states'", at_key=True)
    return Mistake(f"unknown key {word!r}", word, known, at_key=True)


def _key(path: Path) -> str:
    """Return "'standoff', item 2: ": the key an error is about."""
    names = [at for at, step in enumerate(path) if isinstance(step, str)]
    after = path[names[-1] + 1 :] if names else path
    items = [f"item {step + 1}" for step in after if isinstance(step, int)]
    parts = [repr(path[names[-1]]), *items] if names else items
    return f"{', '.join(parts)}: " if parts else ""


def _missing(path: Path, field: FieldInfo | None) -> str:
    wanted = "" if field is None else expected(field)
    if isinstance(path[-1], int):
        return f"{_key(path)}missing; expected {wanted or 'a longer list'}"
    return f"missing key {path[-1]!r}" + (f": {wanted}" if wanted else "")


def _wrong_value(error: Mapping[str, Any], field: FieldInfo | None) -> str:
    kind, context, value = str(error["type"]), error.get("ctx", {}), error["input"]
    if kind in _RANGE_ERRORS:
        return f"must be {_bounds(field, context)}, got {shown(value)}"
    if kind == "union_tag_not_found":
        return "missing key 'use'"
    wanted = _wanted(kind, field)
    if kind.endswith(_TYPE_ERRORS):
        return f"expected {wanted}, got {shown(value)}{_remedy(wanted, value)}"
    if kind == "too_short":
        return f"needs at least {context['min_length']}, got {context['actual_length']}"
    if kind == "too_long":
        return f"expected {wanted}, got a list of {context['actual_length']}"
    message = str(error["msg"])
    return message[:1].lower() + message[1:]


def _wanted(kind: str, field: FieldInfo | None) -> str:
    if field is None:
        return "a mapping"
    said = next(forms_in(field), None)
    if said is None:
        return expected(field)
    return f"a number ({unit_of(field)})" if kind.startswith("float") else said


def _remedy(wanted: str, value: object) -> str:
    """Return how to mend a value of the wrong type where its text shows what was meant."""
    if wanted.startswith("a list") and isinstance(value, dict):
        return ": begin each entry with '- '"
    if wanted.startswith("a mapping") and isinstance(value, str) and _NO_SPACE.match(value):
        return ": put a space after ':'"
    return ""


def _unknown(path: Path, value: object, allowed: str) -> Mistake:
    names = re.findall(r"'([^']*)'", allowed)
    if not names:
        return Mistake(f"{_key(path)}expected {allowed}, got {shown(value)}")
    return Mistake(f"{_key(path)}{shown(value)} is unknown", str(value), names)


def _bounds(field: FieldInfo | None, context: Mapping[str, Any]) -> str:
    unit = unit_of(field)
    given = {word: context[name] for name, word in BOUNDS.items() if name in context}
    limits = dict(limits_of(field)) or given
    parts = " and ".join(f"{word} {limit:g}" for word, limit in limits.items()) or "finite"
    return parts + (f" {unit}" if unit else "")
