"""Variables of a mission: what the chart remembers besides where it stands."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Self, TypeGuard

from pydantic import Field, StrictBool, StrictFloat, StrictInt, StrictStr, model_validator

from missionkit.chart.model.model_base import MissionPart
from missionkit.chart.text.located_data import LocatedTable, place_of
from missionkit.chart.text.mistake import sentence, sentences
from missionkit.errors import nearest
from missionkit.units import Number

Value = bool | int | float | str
Values = Mapping[str, Value]
LARGEST_WHOLE_NUMBER = 2**53  # whole numbers beyond are not exact as floating point


class Variable(MissionPart):
    """A variable: its type is that of its first value, which it keeps for good."""

    initial: StrictBool | StrictInt | StrictFloat | StrictStr
    min: Number | None = Field(default=None, description="least value, numbers only")
    max: Number | None = Field(default=None, description="greatest value, numbers only")
    one_of: Annotated[tuple[str, ...], Field(strict=False)] = Field(
        default=(), description="possible values, strings only"
    )

    @model_validator(mode="before")
    @classmethod
    def _written_short(cls, data: object) -> object:
        if isinstance(data, bool | int | float | str):
            place = place_of(data)
            return LocatedTable(place).extended("initial", data, place)
        return data

    @model_validator(mode="after")
    def _in_range(self) -> Self:
        bounded = self.min is not None or self.max is not None
        if bounded and not is_number(self.initial):
            raise sentences(sentence("only a number has 'min' and 'max'"))
        if self.min is not None and self.max is not None and self.min > self.max:
            raise sentences(sentence(f"'min' {self.min:g} is above 'max' {self.max:g}"))
        if is_number(self.initial) and not self.admits(self.initial):
            raise sentences(sentence(f"{self.initial} is not within 'min' and 'max'", "initial"))
        if self.one_of and not isinstance(self.initial, str):
            raise sentences(sentence("only a string has 'one_of'"))
        if not self.admits(self.initial):
            hint = nearest(str(self.initial), self.one_of)
            raise sentences(sentence(f"{self.initial!r} is not in 'one_of'; {hint}", "initial"))
        return self

    def admits(self, value: Value) -> bool:
        """Say whether a value is of the variable's type and within its range."""
        if not is_number(value) or not is_number(self.initial):
            return alike(value, self.initial) and (not self.one_of or value in self.one_of)
        if isinstance(self.initial, int) and not isinstance(value, int):
            return False
        if isinstance(value, int) and abs(value) > LARGEST_WHOLE_NUMBER:
            return False
        low = -math.inf if self.min is None else self.min
        high = math.inf if self.max is None else self.max
        return math.isfinite(value) and low <= value <= high

    @property
    def described(self) -> str:
        """Description of a valid value, with its range."""
        if self.one_of:
            return f"one of {', '.join(self.one_of)}"
        low = "" if self.min is None else f", at least {self.min:g}"
        high = "" if self.max is None else f", at most {self.max:g}"
        return self.type_name + low + high

    @property
    def type_name(self) -> str:
        """Name of the type, for messages."""
        return {bool: "true or false", int: "a whole number", float: "a number", str: "a string"}[
            type(self.initial)
        ]


def alike(one: Value, other: Value) -> bool:
    """Say whether two values are both numbers, both truth values or both texts."""
    return is_number(one) == is_number(other) and isinstance(one, bool) == isinstance(other, bool)


def is_number(value: object) -> TypeGuard[float]:
    """Say whether a value is a number; truth values are not."""
    return isinstance(value, int | float) and not isinstance(value, bool)
