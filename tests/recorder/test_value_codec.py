"""Values come back the same, to the bit; text from elsewhere runs no code."""

from __future__ import annotations

import json
import math
import sys
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rehearsed import flown, plain, short_stage

from missionkit.geometry import Transform
from missionkit.messages import Action, Battery, Verdict
from missionkit.recorder import value_codec
from missionkit.recorder.value_codec import (
    NotPlainError,
    NotReadableError,
    is_plain,
    read,
    written,
)

LEAVES = (
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text() | st.binary()
)
KEYS = st.integers() | st.text() | st.tuples(st.integers(), st.text())
VALUES = st.recursive(
    LEAVES,
    lambda parts: (
        st.lists(parts)
        | st.lists(parts).map(tuple)
        | st.dictionaries(KEYS, parts)
        | st.frozensets(KEYS)
        | st.builds(Battery, parts, parts, parts)
    ),
)


@given(VALUES)
def test_every_plain_value_comes_back(value):
    back = read(written(value))
    assert back == value
    assert type(back) is type(value)


@given(st.floats())
def test_every_float_comes_back_to_the_bit(value):
    assert read(written(value)).hex() == value.hex()


@pytest.mark.parametrize(
    "array",
    [
        np.array([0.1, -0.0, math.inf, math.nan]),
        np.empty((0, 7)),
        np.arange(6, dtype=np.int32).reshape(2, 3).T,
        np.array([True, False]),
        np.arange(4, dtype=">u2"),
    ],
)
def test_arrays_come_back_to_the_bit_and_can_be_written_to(array):
    back = read(written(array))
    np.testing.assert_array_equal(back, array)
    assert (back.shape, back.dtype) == (array.shape, array.dtype.newbyteorder("="))
    assert np.array_equal(np.signbit(back.astype(float)), np.signbit(array.astype(float)))
    assert back.flags.writeable
    assert back.flags.c_contiguous


def test_numbers_of_numpy_stay_what_they_are():
    back = read(written(np.float32(0.1)))
    assert (back, type(back)) == (np.float32(0.1), np.float32)


def test_classes_of_the_package_come_back():
    link = Transform(np.array([1.0, 0.0, 0.0, 0.0]), np.array([1.0, 2.0, 3.0]))
    back, action = read(written((link, Action.LAND)))
    assert plain(back) == plain(link)
    assert action is Action.LAND


HOP = """\
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 2}, transitions: [{to: land, when: done}]}
  land: {kind: land}
"""


def test_the_memory_of_a_flight_comes_back():
    memory = flown(short_stage(HOP)).result.flown.memory
    assert plain(read(written(memory))) == plain(memory)


class Foreign(NamedTuple):
    number: int


@pytest.mark.parametrize(
    "value",
    [Foreign(1), object(), {1, 2}, lambda: 0, np.array([object()]), (1, [Foreign(1)]), 1j],
)
def test_what_is_not_plain_is_not_written(value):
    assert not is_plain(value)
    with pytest.raises(NotPlainError):
        written(value)


def test_a_value_that_holds_itself_is_not_written():
    loop: list[Any] = []
    loop.append(loop)
    assert not is_plain(loop)
    with pytest.raises(NotPlainError):
        written(loop)


HOSTILE = [
    {"os:system": ["touch hacked"]},
    {"builtins:eval": ["1"]},
    {"missionkit.__main__:main": []},
    {"missionkit.recorder.value_codec:json.loads": ["1"]},
    {"missionkit.recorder.value_codec:sys": []},
    {"missionkit.recorder.value_codec:np.ndarray": [1]},
    {"missionkit.recorder.flight_recorder:FlightRecorder": ["."]},
    {"missionkit.recorder.value_codec:NamedTuple": []},
    {"missionkit.messages:Battery": [1, 2, 3]},  # not where it is defined
    {"missionkit.messages.observation:Battery": [1, 2]},
    {"missionkit.messages.command:Action": "explode"},
    {"missionkit.nowhere:Thing": []},
    {"array": ["|O", [1], "AAAAAAAAAAA="]},
    {"array": ["<f8", [-1, 3], "AAAAAAAAAAA="]},
    {"array": ["<f8", [1 << 60], "AAAAAAAAAAA="]},
    {"int": "ten"},
    {"float": "x", "int": "1"},
    {},
    {"dict": [[{"list": []}, 1]]},  # a key that cannot be one
    {"bytes": "***"},
    {"list": 3},
]


@pytest.mark.parametrize("value", HOSTILE, ids=lambda value: str(value)[:50])
def test_a_foreign_text_is_refused_and_imports_nothing(value):
    before = set(sys.modules)
    with pytest.raises(NotReadableError):
        read(json.dumps(value))
    assert set(sys.modules) == before


class SprungError(BaseException):
    """Code ran that no text may run."""


def spring(*_: Any) -> None:
    raise SprungError


@dataclass(frozen=True)
class Checked:
    number: int
    __post_init__ = spring


@dataclass
class Changing:
    number: int
    __setattr__ = spring


class Ordinary:
    __init__ = spring


@pytest.mark.parametrize("kind", [Checked, Changing, Ordinary])
def test_a_class_with_its_own_code_is_not_built(monkeypatch, kind):
    monkeypatch.setattr(kind, "__module__", value_codec.__name__)
    monkeypatch.setattr(value_codec, kind.__name__, kind, raising=False)
    with pytest.raises(NotReadableError):
        read(json.dumps({f"{value_codec.__name__}:{kind.__name__}": [1]}))


@pytest.mark.parametrize("text", ["", "{", "[1,", "nul", "[" * 100_000, '"\\ud8"'])
def test_invalid_json_is_refused(text):
    with pytest.raises(NotReadableError):
        read(text)


VERDICT = "missionkit.messages.verdict:Verdict"


@pytest.mark.parametrize(
    ("values", "fields"),
    [
        ([True, "seen"], {}),  # a journal that does not name the fields: the last are missing
        (["seen", True], {VERDICT: ("why", "holds")}),  # one that does: any may be
    ],
)
def test_a_class_that_has_gained_fields_is_read_with_their_defaults(values, fields):
    back = value_codec.reader(fields)(json.dumps({VERDICT: values}))
    assert back == Verdict(holds=True, why="seen")


@pytest.mark.parametrize(
    ("values", "fields", "why"),
    [
        ([], {}, "was written without holds, which this missionkit needs"),
        (["seen"], {VERDICT: ("why",)}, "was written without holds, which this missionkit needs"),
        ([1.0] * 9, {}, "was written with 9 values, this missionkit knows 5"),
        ([True, 1.0], {VERDICT: ("holds", "x")}, "was written with x, which this missionkit does"),
        ([True], {VERDICT: ("holds", "why")}, "was written with 1 of its 2 values"),
    ],
)
def test_a_shape_that_cannot_be_read_is_named(values, fields, why):
    with pytest.raises(NotReadableError, match=f"{VERDICT} {why}"):
        value_codec.reader(fields)(json.dumps({VERDICT: values}))


def test_the_classes_of_a_text_are_found_with_their_fields():
    (name,) = value_codec.classes_in(written((Verdict(holds=True), {"a": (1, "b")})))
    assert name == VERDICT
    assert value_codec.field_names(name) == Verdict._fields
