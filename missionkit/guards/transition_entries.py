"""The entries of a matrix of transition probabilities: numbers, live quantities, the rest."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Any, NamedTuple, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    GetJsonSchemaHandler,
    model_validator,
)
from pydantic_core import CoreSchema
from typing_extensions import override

from missionkit.errors import nearest
from missionkit.guards.detection_confidence import ArucoConfidence, Window
from missionkit.guards.named_quantities import (
    HOME,
    NamedQuantity,
    Value,
    named_quantity,
    quantity_names,
)
from missionkit.messages import Estimate, Verdict
from missionkit.plugin_protocols import Inputs, NamedInput

SUM_ERROR = 1e-9  # by which a row may miss 1
ROUNDING = 1e-12  # a remainder below it is an error of rounding
REST = "rest"
SOURCES = ("rest", "quantity", "variable", "guard", "product")
UNUSED = (None, False, ())
Span = tuple[float, float]
CERTAIN: Span = (0.0, 1.0)


class ConfidenceWindow(NamedTuple):
    """The last frames in which a target is counted."""

    target: str
    frames: int


class Readings(NamedTuple):
    """Sources of the entries at one tick."""

    seen: Estimate
    windows: Mapping[ConfidenceWindow, Window]
    inputs: Inputs


class Entry(BaseModel):
    """A transition probability: a number, `rest`, or a quantity divided by a reference.

    p = clamp(x / over, 0, 1), or 1 - p with `complement`; x is a quantity of the estimate, a
    variable, the value of a guard, or a product of such terms, which are clamped together.
    """

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)

    number: float | None = Field(default=None, ge=0, le=1, description="written alone")
    rest: bool = Field(default=False, description="what the row leaves of 1; written as a word")
    quantity: str | None = Field(default=None, description="of the estimate, by name")
    variable: str | None = Field(default=None, description="of the mission")
    guard: str | None = Field(default=None, description="of the mission, whose value it is")
    product: tuple[Entry, ...] = Field(default=(), description="terms to be multiplied")
    over: float = Field(default=1.0, gt=0, description="reference that the quantity is divided by")
    complement: bool = Field(default=False, description="one minus it")
    window: int = Field(default=30, ge=1, le=10_000, description="frames of a confidence")

    @model_validator(mode="before")
    @classmethod
    def _written_short(cls, data: object) -> object:
        if isinstance(data, bool) or data is None:
            raise ValueError("expected a number from 0 to 1, 'rest', or a quantity")
        if isinstance(data, int | float):
            return {"number": data}
        if isinstance(data, str):
            return {"rest": True} if data == REST else {"quantity": data}
        if isinstance(data, dict) and isinstance(data.get("product"), list):
            return {**data, "product": tuple(data["product"])}
        return data

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        given = [source for source in SOURCES if getattr(self, source) not in UNUSED]
        given += [] if self.number is None else ["number"]
        if len(given) != 1:
            got = ", ".join(given) or "none of them"
            raise ValueError(f"expected one of {', '.join(SOURCES[1:])}, got {got}")
        if any(term.rest for term in self.product):
            raise ValueError("'rest' cannot be a factor of a product")
        if self.quantity is not None and self.named is None:
            known = nearest(self.quantity, quantity_names())
            raise ValueError(f"unknown quantity {self.quantity!r}; {known}")
        return self

    @override
    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Allow the short forms beside the long one."""
        short: list[dict[str, Any]] = [
            {"type": "number", "minimum": 0, "maximum": 1},
            {"type": "string", "description": "rest, or a quantity of the estimate"},
        ]
        return {"anyOf": [*short, handler(schema)]}

    @property
    def named(self) -> NamedQuantity | None:
        """The quantity of the estimate, if it is one."""
        return None if self.quantity is None else named_quantity(self.quantity)

    @override
    def __str__(self) -> str:
        if self.rest:
            return REST
        if self.number is not None:
            return f"{self.number:g}"
        factors = (f"({it})" if it.complement else str(it) for it in self.product)
        said = " * ".join(factors) or self._name
        said = said if self.over == 1.0 else f"{said} / {self.over:g}"
        return f"1 - {said}" if self.complement else said

    @property
    def _name(self) -> str:
        return f"value of {self.guard}" if self.guard else str(self.quantity or self.variable)

    @property
    def live(self) -> bool:
        """Whether it depends on the tick."""
        return self.number is None and not self.rest

    def inputs(self, path: tuple[str | int, ...]) -> list[NamedInput]:
        """Return what of the mission it names; `path` leads to it."""
        found = [it for n, term in enumerate(self.product) for it in term.inputs((*path, n))]
        if self.guard is not None:
            found.append(NamedInput("guard", self.guard, path))
        if self.variable is not None:
            found.append(NamedInput("variable", self.variable, path))
        if self.named is not None and self.named.target not in {None, HOME}:
            found.append(NamedInput("target", str(self.named.target), path))
        return found

    def confidences(self) -> list[ConfidenceWindow]:
        """Return the windows that it needs."""
        found = [it for term in self.product for it in term.confidences()]
        if self.named is not None and self.named.read is None:
            found.append(ConfidenceWindow(str(self.named.target), self.window))
        return found

    def sees(self) -> set[str]:
        """Return the targets whose marker must be looked for."""
        own = set() if self.named is None else {self.named.quantity.sees}
        return {it for it in own.union(*(term.sees() for term in self.product)) if it}

    def probability(self, readings: Readings) -> Value:
        """Return its value at one tick, or why that is not known."""
        x = self._term(readings)
        if isinstance(x, str):
            return x
        if math.isnan(x):
            return f"{self} is not a number"
        return min(max(x, 0.0), 1.0) if not self.complement else 1.0 - min(max(x, 0.0), 1.0)

    def _term(self, readings: Readings) -> Value:
        """Return x / over."""
        if self.number is not None:
            return self.number
        if self.product:
            return _multiplied([term.factor(readings) for term in self.product], self.over)
        x = self._read(readings)
        return x if isinstance(x, str) else x / self.over

    def factor(self, readings: Readings) -> Value:
        """Return its value as a factor of a product: not clamped, unless it is a complement."""
        return self.probability(readings) if self.complement else self._term(readings)

    def _read(self, readings: Readings) -> Value:
        if self.guard is not None:
            return _value_of(self.guard, readings.inputs.answers[self.guard])
        if self.variable is not None:
            return float(readings.inputs.variables[self.variable])
        named = self.named
        if named is None:
            return f"{self} is not known"
        if named.read is not None:
            return named.read(readings.seen)
        window = readings.windows[ConfidenceWindow(str(named.target), self.window)]
        return window.hits.bit_count() / self.window if window.frames else "no frame was due yet"

    def span(self) -> Span:
        """Return the least and the greatest value that it can have."""
        if self.rest:
            return CERTAIN
        low, high = self._term_span()
        low, high = min(max(low, 0.0), 1.0), min(max(high, 0.0), 1.0)
        return (1.0 - high, 1.0 - low) if self.complement else (low, high)

    def _term_span(self) -> Span:
        if self.number is not None:
            return self.number, self.number
        if self.product or self.named is None:
            return CERTAIN
        return self.named.quantity.least / self.over, self.named.quantity.most / self.over


def _multiplied(factors: Sequence[Value], over: float) -> Value:
    unknown = next((it for it in factors if isinstance(it, str)), None)
    if unknown is not None:
        return unknown
    return math.prod(it for it in factors if not isinstance(it, str)) / over


def _value_of(name: str, verdict: Verdict) -> Value:
    if verdict.value is None:
        return f"{name}: {verdict.why or 'it gives no value'}"
    return verdict.value


def _adds_up(row: tuple[Entry, ...]) -> tuple[Entry, ...]:
    """Refuse a row that cannot add up to 1."""
    if sum(entry.rest for entry in row) > 1:
        raise ValueError("only one entry of a row can be 'rest'")
    total = math.fsum(entry.number for entry in row if entry.number is not None)
    loose = any(entry.number is None for entry in row)
    if total > 1.0 + SUM_ERROR or not (loose or abs(total - 1.0) <= SUM_ERROR):
        alone = "its numbers alone add" if loose else "the row adds"
        raise ValueError(f"{alone} up to {total:.12g}, not to 1")
    return row


ProbabilityRow = Annotated[tuple[Entry, ...], AfterValidator(_adds_up)]
"""Out of one state: entries that add up to 1; one may be `rest`."""


def evaluated(row: Sequence[Entry], readings: Readings) -> list[float] | str:
    """Return the probabilities of a row at one tick, or why they are not known."""
    values, rest = [0.0] * len(row), None
    for at, entry in enumerate(row):
        if entry.rest:
            rest = at
            continue
        p = entry.probability(readings)
        if isinstance(p, str):
            return p
        values[at] = p
    return _completed(values, rest)


def numbers(row: Sequence[Entry]) -> list[float]:
    """Return the probabilities of a row of numbers, of which one may be the rest."""
    values = [0.0 if entry.number is None else entry.number for entry in row]
    rest = next((at for at, entry in enumerate(row) if entry.rest), None)
    completed = _completed(values, rest)
    return values if isinstance(completed, str) else completed


def _completed(values: list[float], rest: int | None) -> list[float] | str:
    """Return a row with what it leaves of 1 at `rest`, or how it does not add up."""
    total = math.fsum(values)
    if total > 1.0 + SUM_ERROR or (rest is None and total < 1.0 - SUM_ERROR):
        return f"the row adds up to {total:.6g}, not to 1"
    if rest is not None and 1.0 - total > ROUNDING:
        values[rest] = 1.0 - total
    return values


class ConfidenceWindows:
    """The windows that some entries need; their memory is a tuple of `Window`."""

    def __init__(self, entries: Iterable[Entry]) -> None:
        every = (it for entry in entries for it in entry.confidences())
        self._guards = {
            it: ArucoConfidence(target=it.target, window=it.frames) for it in dict.fromkeys(every)
        }

    def begin(self) -> tuple[Window, ...]:
        """Return the memory before the first frame."""
        return tuple(guard.begin() for guard in self._guards.values())

    def advance(self, memory: Sequence[Window], seen: Estimate) -> tuple[Window, ...]:
        """Return the memory after the frames of one tick."""
        pairs = zip(self._guards.values(), memory, strict=True)
        return tuple(guard.advance(window, seen) for guard, window in pairs)

    def named(self, memory: Sequence[Window]) -> dict[ConfidenceWindow, Window]:
        """Return each window of a memory by what it counts."""
        return dict(zip(self._guards, memory, strict=True))
