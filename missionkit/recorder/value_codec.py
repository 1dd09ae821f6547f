"""Values as JSON text and back; reading builds plain data and runs nothing.

    None, bool, int, float, str      themselves; floats keep every bit
    tuple                            array
    list, dict, frozenset, bytes     {"list": ...}, {"dict": [[key, value], ...]}, ...
    numpy array or number            {"array": [dtype, shape, base64]}
    NamedTuple of the package        {"missionkit.messages.observation:Battery": [...]}
    frozen dataclass of the package  {"missionkit.geometry:Transform": [...]}
    enum of the package              {"missionkit.messages.command:Action": "land"}

A class is looked up among the modules of the package that are loaded already: a text can make
nothing be imported, and nothing be called but what builds a tuple, a dataclass without code of
its own, or an enum's member.

The values of an instance stand in the order of its fields. Who keeps the names of the fields too
(`classes_in`, `field_names`) can read a text after a class has gained fields with defaults.
"""

from __future__ import annotations

import base64
import binascii
import json
import math
import re
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import lru_cache
from typing import Any, cast

import numpy as np

PACKAGE_PREFIX = "missionkit."
DTYPE = re.compile(r"[<|][biuf][1248]")
# what `_plain` makes contains nothing twice: the encoder need not look for circles
_encoded = json.JSONEncoder(check_circular=False, allow_nan=False, separators=(",", ":")).encode
LARGE = 1 << 63  # integers from here on are written in hexadecimal
CLASS_NAME = re.compile(r'"(missionkit\.[\w.]+:[\w.]+)":\[')
Fields = tuple[str, ...]
Build = Callable[[Any], Any]
NO_FIELDS: Mapping[str, Fields] = {}


class NotPlainError(Exception):
    """A value that cannot be written."""


class NotReadableError(Exception):
    """A text that this module did not write."""


def written(value: Any) -> str:
    """Return a value as text.

    Raises:
        NotPlainError: it holds something that is none of the above.
    """
    try:
        return _encoded(_plain(value))
    except RecursionError as error:
        raise NotPlainError("a value that contains itself") from error


def read(text: str) -> Any:
    """Return the value that `written` was given.

    Raises:
        NotReadableError: it was not given any.
    """
    return reader()(text)


def reader(fields_written: Mapping[str, Fields] = NO_FIELDS) -> Callable[[str], Any]:
    """Return what `read` does, for many texts of the same writer.

    Args:
        fields_written: names of the fields that a class had when it was written. A class that is
            not among them is taken to have gained fields at its end, if any.
    """
    classes: dict[str, Build] = {}

    def built(value: Any) -> Any:
        kind = value.__class__
        if kind is list:
            return tuple([built(part) for part in value])
        if kind is not dict:
            return value
        ((tag, content),) = value.items()
        if tag in values:
            return values[tag](content)
        build = classes.get(tag)
        if build is None:
            build = classes[tag] = _builder(tag, fields_written.get(tag))
        return build(built(content))

    values = _value_builders(built)

    def read_text(text: str) -> Any:
        try:
            return built(json.loads(text))
        except (ValueError, TypeError, KeyError, RecursionError, binascii.Error) as error:
            raise NotReadableError(str(error)) from error

    return read_text


def classes_in(text: str) -> frozenset[str]:
    """Return the names of the classes whose instances a text may hold."""
    return frozenset(CLASS_NAME.findall(text))


def field_names(name: str) -> Fields:
    """Return the names of the fields of a class as `written` orders them; () if it is none."""
    kind = _class_of(name)
    return () if kind is None or issubclass(kind, Enum) else tuple(_defaults(kind))


def is_plain(value: Any) -> bool:
    """Say whether a value can be written."""
    try:
        _plain(value)
    except (NotPlainError, RecursionError):
        return False
    return True


def _plain(value: Any) -> Any:
    kind: Any = type(value)
    return _writer_of(kind)(value)


def _parts(values: Iterable[Any]) -> list[Any]:
    """Return the parts of a value; most are text, None or a float, which no writer changes."""
    return [
        part
        if (kind := type(part)) in UNCHANGED or (kind is float and math.isfinite(part))
        else _plain(part)
        for part in values
    ]


@lru_cache(512)
def _writer_of(kind: Any) -> Callable[[Any], Any]:
    """Return what makes JSON data of the values of a class.

    Raises:
        NotPlainError: nothing does.
    """
    if kind in WRITERS:
        return WRITERS[kind]
    if issubclass(kind, Enum):
        name = _name_of(kind)
        return lambda value: {name: _plain(value.value)}
    if issubclass(kind, tuple):
        name = _name_of(kind)
        return lambda value: {name: _parts(value)}
    if is_dataclass(kind):
        name, own = _name_of(kind), tuple(part.name for part in fields(kind))
        return lambda value: {name: _parts([getattr(value, part) for part in own])}
    if issubclass(kind, Mapping):  # read-only ones too
        return _dict
    if issubclass(kind, np.generic):
        return lambda value: _array(np.asarray(value))
    raise NotPlainError(f"{kind.__module__}.{kind.__qualname__}")


def _itself(value: Any) -> Any:
    return value


def _int(value: int) -> Any:
    return value if -LARGE < value < LARGE else {"int": hex(value)}


def _float(value: float) -> Any:
    return value if math.isfinite(value) else {"float": repr(value)}


def _tuple(value: tuple[Any, ...]) -> Any:
    return _parts(value)


def _list(value: list[Any]) -> Any:
    return {"list": _parts(value)}


def _dict(value: Mapping[Any, Any]) -> Any:
    return {"dict": [[_plain(key), _plain(part)] for key, part in value.items()]}


def _set(value: frozenset[Any]) -> Any:
    return {"set": sorted((_plain(part) for part in value), key=repr)}


def _bytes(value: bytes) -> Any:
    return {"bytes": base64.b64encode(value).decode("ascii")}


def _array(value: np.ndarray[Any, Any]) -> Any:
    dtype, native = _dtype_of(value.dtype)
    data = value.tobytes() if native else value.astype(dtype).tobytes()
    return {"array": [dtype, list(value.shape), base64.b64encode(data).decode("ascii")]}


@lru_cache(64)
def _dtype_of(dtype: np.dtype[Any]) -> tuple[str, bool]:
    """Return how a little-endian array of a dtype is named, and whether it is one already."""
    little = dtype.newbyteorder("<")
    if not DTYPE.fullmatch(little.str):
        raise NotPlainError(f"an array of {dtype}")
    return little.str, little == dtype


def _name_of(kind: Any) -> str:
    name = f"{kind.__module__}:{kind.__qualname__}"
    if _class_of(name) is not kind:
        raise NotPlainError(name.replace(":", "."))
    return name


UNCHANGED = frozenset((type(None), bool, str))
WRITERS: Mapping[type, Callable[[Any], Any]] = {
    type(None): _itself,
    bool: _itself,
    str: _itself,
    int: _int,
    float: _float,
    tuple: _tuple,
    list: _list,
    dict: _dict,
    frozenset: _set,
    bytes: _bytes,
    np.ndarray: _array,
}


def _builder(name: str, fields_written: Fields | None) -> Build:
    """Return what builds an instance of a class from its values, in the order they were written."""
    kind: Any = _class_of(name)
    if kind is None:
        raise NotReadableError(f"{name} is not a plain class of this missionkit")
    if issubclass(kind, Enum):
        return cast(Build, kind)
    make = kind._make if issubclass(kind, tuple) else lambda values: kind(*values)
    now = _defaults(kind)
    if fields_written is None or fields_written == tuple(now):
        return _completing(name, make, now)
    unknown = [field for field in fields_written if field not in now]
    if unknown:
        has = f"{name} was written with {', '.join(unknown)}"
        raise NotReadableError(f"{has}, which this missionkit does not know")
    _check_defaults(name, {it: now[it] for it in now if it not in fields_written})

    def build(values: Any) -> Any:
        count = len(fields_written)
        if len(values) != count:
            had = f"{name} was written with {len(values)} of its {count} values"
            raise NotReadableError(had)
        given = dict(zip(fields_written, values, strict=True))
        return make([given.get(field, default) for field, default in now.items()])

    return build


def _completing(name: str, make: Build, now: Mapping[str, Any]) -> Build:
    """Return what builds an instance whose last fields may be missing."""
    count, names = len(now), list(now)

    def build(values: Any) -> Any:
        if len(values) == count:
            return make(values)
        if len(values) > count:
            had = f"{name} was written with {len(values)} values"
            raise NotReadableError(f"{had}, this missionkit knows {count}")
        missing = {it: now[it] for it in names[len(values) :]}
        _check_defaults(name, missing)
        return make((*values, *missing.values()))

    return build


def _check_defaults(name: str, missing: Mapping[str, Any]) -> None:
    if bare := [field for field, default in missing.items() if default is MISSING]:
        lacks = f"{name} was written without {', '.join(bare)}"
        raise NotReadableError(f"{lacks}, which this missionkit needs")


def _defaults(kind: Any) -> dict[str, Any]:
    """Return the default of each field, `MISSING` where there is none."""
    if issubclass(kind, tuple):
        return {name: kind._field_defaults.get(name, MISSING) for name in kind._fields}
    return {it.name: it.default for it in fields(kind)}


def _class_of(name: str) -> type | None:
    """Return the plain class of that name, if a loaded module of the package defines it."""
    module, _, path = name.partition(":")
    found: Any = sys.modules.get(module) if module.startswith(PACKAGE_PREFIX) else None
    for part in path.split("."):
        found = vars(found).get(part) if hasattr(found, "__dict__") else None
    if not isinstance(found, type) or found.__module__ != module:
        return None
    return found if _is_data(found) else None


def _is_data(kind: Any) -> bool:
    """Say whether building an instance runs no code of the package."""
    if is_dataclass(kind):
        own_code = hasattr(kind, "__post_init__") or not vars(kind)["__dataclass_params__"].frozen
        return not own_code and all(part.init for part in fields(kind))
    return issubclass(kind, Enum) or (issubclass(kind, tuple) and hasattr(kind, "_fields"))


def _array_of(content: Any) -> Any:
    dtype, shape, data = content
    if not DTYPE.fullmatch(dtype):
        raise NotReadableError(f"an array of {dtype}")
    flat = np.frombuffer(base64.b64decode(data, validate=True), dtype)
    return flat.reshape([int(size) for size in shape]).copy()[()]


def _value_builders(built: Build) -> Mapping[str, Build]:
    return {
        "int": lambda text: int(text, 16),
        "float": float,
        "list": lambda parts: [built(part) for part in parts],
        "dict": lambda pairs: {built(key): built(part) for key, part in pairs},
        "set": lambda parts: frozenset(built(part) for part in parts),
        "bytes": lambda text: base64.b64decode(text, validate=True),
        "array": _array_of,
    }
