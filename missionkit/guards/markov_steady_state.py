"""The long run of a Markov chain whose transition probabilities are read in flight."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Annotated, Any, ClassVar, Self

from pydantic import Field, model_validator
from typing_extensions import override

from missionkit.errors import nearest
from missionkit.guards.detection_confidence import Window
from missionkit.guards.estimated_chain import MOST_STATES, EstimatedChain, require_square
from missionkit.guards.transition_entries import (
    ConfidenceWindows,
    Entry,
    ProbabilityRow,
    Readings,
    Span,
    evaluated,
    numbers,
)
from missionkit.markov.stationary import Stationary, stationary
from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.plugin import CompositeGuard, InFile
from missionkit.plugin_protocols import Inputs, NamedInput
from missionkit.units import Fraction

Rows = Mapping[str, Mapping[str, Entry]]
ZERO_ENTRY = Entry(number=0.0)


class MarkovSteadyState(CompositeGuard):
    """Holds while the steady-state probability of a state of a Markov chain is large, or small.

    π A = π, Σ π = 1: the share of its steps that the chain A spends in the state `of`, if its
    transition probabilities stayed as they are at this tick (P3, sections V-B and V-D). Entries of
    the matrix, from the state of the row to that of the column, are numbers, live quantities,
    each clamped to [0, 1], or `rest`, what the row leaves of 1.

    Unknown where the distribution is not unique, because the chain has more than one set of states
    that it cannot leave; where a quantity is unknown; and where a row does not add up to 1. A
    state that the chain leaves for good has probability 0. A chain that goes round in a circle has
    its distribution all the same, and the verdict says so.
    """

    kind: ClassVar[str] = "markov_steady_state"
    target_keys: ClassVar[tuple[str, ...]] = ()
    of: str = Field(description="state whose probability it is")
    at_least: Fraction | None = Field(default=None, description="least probability")
    at_most: Fraction | None = Field(default=None, description="greatest probability")
    states: tuple[str, ...] = Field(
        default=(), max_length=MOST_STATES, description="names of the chain's states"
    )
    matrix: tuple[ProbabilityRow, ...] = Field(
        default=(), description="a row for each state: numbers, quantities, or rest"
    )
    chain: Annotated[EstimatedChain | None, InFile(EstimatedChain)] = Field(
        default=None, description="file of a campaign's chain, instead of states and matrix"
    )
    rows: Rows = Field(default={}, description="rows in place of the chain's: state -> entry")

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if (self.at_least is None) == (self.at_most is None):
            raise ValueError("expected one of 'at_least' and 'at_most'")
        if self.chain is not None and (self.states or self.matrix):
            raise ValueError("'chain' says states and matrix; leave those out, or use 'rows'")
        if self.chain is None and (self.rows or not self.states):
            raise ValueError("expected 'states' and 'matrix', or 'chain', which may have 'rows'")
        require_square(self.names, self.matrix if self.chain is None else self.chain.matrix)
        for name in (self.of, *self.rows, *(to for row in self.rows.values() for to in row)):
            if name not in self.names:
                raise ValueError(f"unknown state {name!r}; {nearest(name, self.names)}")
        if (found := self._constant) is not None and found.probabilities is None:
            raise ValueError(self._ambiguous(found.closed))
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """The states of the chain."""
        return self.states if self.chain is None else self.chain.states

    @cached_property
    def entries(self) -> tuple[tuple[Entry, ...], ...]:
        """The matrix, with the rows that replace those of the file."""
        if self.chain is None:
            return self.matrix
        return tuple(
            tuple(self.rows[state].get(to, ZERO_ENTRY) for to in self.names)
            if state in self.rows
            else learned
            for state, learned in zip(self.names, self.chain.matrix, strict=True)
        )

    @override
    def text(self) -> str:
        limit = "at least" if self.at_least is not None else "at most"
        return f"of {self.of} {limit} {self._threshold:g}; {self._said}"

    @property
    def _said(self) -> str:
        """The chain in words: what leads from each state to which."""
        shown = [state for state in self.names if self.chain is None or state in self.rows]
        rows = [self._row_said(state) for state in shown]
        learned = [] if self.chain is None else [f"a chain of {self.chain.flights} flights"]
        return "; ".join([*learned, *rows])

    def _row_said(self, state: str) -> str:
        row = self.entries[self.names.index(state)]
        leads = [f"{to} {it}" for to, it in zip(self.names, row, strict=True) if it.number != 0.0]
        return f"{state} to {', '.join(leads)}"

    @override
    def named_inputs(self) -> tuple[NamedInput, ...]:
        given = [
            it
            for n, row in enumerate(self.matrix)
            for m, entry in enumerate(row)
            for it in entry.inputs(("matrix", n, m))
        ]
        for state, leads in self.rows.items():
            given += [it for to, e in leads.items() for it in e.inputs(("rows", state, to))]
        return tuple(given)

    @cached_property
    def _windows(self) -> ConfidenceWindows:
        return ConfidenceWindows(entry for row in self.entries for entry in row)

    @override
    def begin(self) -> tuple[Window, ...]:
        return self._windows.begin()

    @override
    def advance(self, memory: Any, seen: Estimate) -> tuple[Window, ...]:
        return self._windows.advance(memory, seen)

    @override
    def check(self, memory: Any, seen: Estimate, inputs: Inputs) -> Verdict:
        readings = Readings(seen, self._windows.named(memory), inputs)
        matrix: list[list[float]] = []
        for state, row in zip(self.names, self.entries, strict=True):
            values = evaluated(row, readings)
            if isinstance(values, str):
                return Verdict.unknown(f"{state}: {values}")
            matrix.append(values)
        found = stationary(matrix)
        if found.probabilities is None:
            return Verdict.unknown(self._ambiguous(found.closed))
        circle = f"the chain has period {found.period}; " if found.period > 1 else ""
        probability = found.probabilities[self.names.index(self.of)]
        why = circle + self._live(matrix)
        if self.at_least is not None:
            return Verdict.at_least(probability, self.at_least, why)
        return Verdict.at_most(probability, self._threshold, why)

    @property
    def _threshold(self) -> float:
        limit = self.at_most if self.at_least is None else self.at_least
        return 0.0 if limit is None else limit

    def _ambiguous(self, closed: tuple[tuple[int, ...], ...]) -> str:
        if len(closed) == 1:
            return "its probabilities are too small to be divided by"
        sets = " or ".join("-".join(self.names[state] for state in each) for each in closed)
        return f"the chain may end in {sets}: its steady state is not unique"

    def _live(self, matrix: list[list[float]]) -> str:
        """Return the entries that depend on the tick, with their values."""
        return ", ".join(
            f"{state} to {to} {matrix[n][m]:.3g}"
            for n, state in enumerate(self.names)
            for m, to in enumerate(self.names)
            if self.entries[n][m].live
        )

    @override
    def region(self) -> Region:
        least, most = self._bounds()
        quantity = Quantity(f"steady-state probability of {self.of} ({self._said})", least, most)
        if self.at_least is not None:
            return Region.of(quantity, Interval.at_least(self.at_least))
        return Region.of(quantity, Interval.at_most(self._threshold))

    @override
    def sees(self) -> frozenset[str]:
        return frozenset().union(*(entry.sees() for row in self.entries for entry in row))

    def _bounds(self) -> Span:
        """Return the least and the greatest probability that the chain can have, at most 0 to 1.

        Exact for numbers alone and for two states, of which p / (p + q) grows with p, the way into
        the state, and shrinks with q, the way out of it.
        """
        if (found := self._constant) is not None and found.probabilities is not None:
            probability = found.probabilities[self.names.index(self.of)]
            return probability, probability
        if len(self.names) != 2:
            return 0.0, 1.0
        here = self.names.index(self.of)
        p, q = self._leaving(1 - here), self._leaving(here)
        return _share(p[0], q[1]), _share(p[1], q[0])

    @property
    def _constant(self) -> Stationary | None:
        """The distribution of a chain of numbers alone, None if it depends on the tick."""
        if any(entry.live for row in self.entries for entry in row):
            return None
        return stationary([numbers(row) for row in self.entries])

    def _leaving(self, state: int) -> Span:
        """Return the span of the probability with which one of two states is left."""
        stays, leaves = self.entries[state][state], self.entries[state][1 - state]
        low, high = stays.span() if leaves.rest else leaves.span()
        return (1.0 - high, 1.0 - low) if leaves.rest else (low, high)


def _share(p: float, q: float) -> float:
    """Return p / (p + q), and its limit for p against 0 where both are 0."""
    return p / (p + q) if p + q > 0.0 else 0.0
