"""Describes the values of a model's fields in words: nouns, units, bounds, keys."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Literal, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel
from pydantic.fields import FieldInfo

Path = tuple[int | str, ...]
_WORDS: Mapping[object, tuple[str, str]] = {
    float: ("a number", "numbers"),
    int: ("a whole number", "whole numbers"),
    bool: ("true or false", "values, true or false"),
    str: ("a string", "texts"),
    dict: ("a mapping", "mappings"),
}
BOUNDS: Mapping[str, str] = {"gt": "above", "ge": "at least", "lt": "below", "le": "at most"}


def field_at(model: type[BaseModel], path: Path) -> FieldInfo | None:
    """Return the innermost field along `path`; steps that are not fields are skipped."""
    field, models = None, [model]
    for step in path:
        found = [inner for each in models if (inner := _field(each, step)) is not None]
        if found:
            field = found[0]
            models = [inner for each in found for inner in models_of(each)]
    return field


def keys_at(model: type[BaseModel], path: Path) -> list[str]:
    """Return the keys that the mapping at `path` may have."""
    field = field_at(model, path)
    models = [model] if field is None else list(models_of(field))
    tagged = [each for each in models if path and path[-1] in _tags(each)]
    return sorted({key for each in tagged or models for key in keys_of(each)})


def keys_of(model: type[BaseModel]) -> list[str]:
    """Return the keys of a model as files write them."""
    return [field.alias or name for name, field in model.model_fields.items()]


def models_of(field: FieldInfo) -> Iterator[type[BaseModel]]:
    """Yield the models that a field's values are made of, or are written as."""
    for metadata in field.metadata:
        yield from getattr(metadata, "written_as", ())
    yield from models_in(field.annotation)


def forms_in(annotation: Any) -> Iterator[str]:
    """Yield what is said of the values in a field that may be written in several forms."""
    if isinstance(annotation, FieldInfo):
        yield from (it.says for it in annotation.metadata if hasattr(it, "written_as"))
        yield from forms_in(annotation.annotation)
    elif hasattr(annotation, "written_as"):
        yield annotation.says
    for part in get_args(annotation):
        yield from forms_in(part)


def models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """Yield the models that a type is made of."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    yield from getattr(annotation, "written_as", ())
    for part in get_args(annotation):
        yield from models_in(part)


def unit_of(annotation: Any) -> str | None:
    """Return the unit that a type or field carries, or None; a pure number has none."""
    if isinstance(annotation, FieldInfo):
        extra = annotation.json_schema_extra
        if isinstance(extra, dict) and "unit" in extra:
            return None if extra["unit"] == "1" else str(extra["unit"])
        return unit_of(annotation.annotation)
    units = (unit_of(part) for part in get_args(annotation))
    return next((unit for unit in units if unit), None)


def limits_of(annotation: Any) -> Iterator[tuple[str, float]]:
    """Yield the bounds of a field as ("above", 0.0)."""
    if isinstance(annotation, FieldInfo):
        for metadata in annotation.metadata:
            if isinstance(metadata, Gt | Ge | Lt | Le):
                name = type(metadata).__name__.lower()
                yield BOUNDS[name], getattr(metadata, name)
        yield from limits_of(annotation.annotation)
    for part in get_args(annotation):
        yield from limits_of(part)


def expected(field: FieldInfo) -> str:
    """Say what a field takes, with its unit: "a list of 3 numbers (m)"."""
    for metadata in field.metadata:
        if hasattr(metadata, "says"):
            return str(metadata.says)
    unit = unit_of(field)
    return noun(field.annotation) + (f" ({unit})" if unit else "")


def noun(annotation: Any) -> str:
    """Return what values of a type are called."""
    if hasattr(annotation, "__metadata__"):
        annotation = get_args(annotation)[0]
    origin, parts = get_origin(annotation), get_args(annotation)
    for known in (annotation, origin):
        if known in _WORDS:
            return _WORDS[known][0]
    if origin is Literal:
        return " or ".join(map(repr, parts))
    if origin is tuple:
        return _list_noun(parts)
    alternatives = dict.fromkeys(noun(part) for part in parts if part is not type(None))
    return " or ".join(alternatives) or "a mapping"


def _list_noun(parts: tuple[Any, ...]) -> str:
    inner = get_args(parts[0])[0] if hasattr(parts[0], "__metadata__") else parts[0]
    many = _WORDS.get(inner, ("", "values"))[1]
    return f"a list of {many}" if parts[-1] is Ellipsis else f"a list of {len(parts)} {many}"


def _field(model: type[BaseModel], step: int | str) -> FieldInfo | None:
    return next((f for n, f in model.model_fields.items() if step == (f.alias or n)), None)


def _tags(model: type[BaseModel]) -> tuple[Any, ...]:
    use = model.model_fields.get("use")
    return () if use is None else get_args(use.annotation)
