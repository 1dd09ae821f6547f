"""The Markov chain of a chart, as a campaign writes it to a file and guards read it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from missionkit.guards.transition_entries import ProbabilityRow

MOST_STATES = 64


def _of_numbers(row: ProbabilityRow) -> ProbabilityRow:
    if any(entry.number is None for entry in row):
        raise ValueError("expected numbers that add up to 1")
    return row


class EstimatedChain(BaseModel):
    """Transition probabilities that flights have shown; every state is a row and a column.

    Beside the states of the chart there is one for each ending, such as `success`. A flight that
    ends begins again: the row of an ending says where flights begin.
    """

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)

    chain: Literal[1] = Field(description="version of the format")
    mission: str = Field(default="", description="that was flown")
    flights: int = Field(default=0, ge=0, description="that it was estimated from")
    states: tuple[str, ...] = Field(min_length=1, max_length=MOST_STATES)
    endings: tuple[str, ...] = Field(default=(), description="those that end a flight")
    matrix: tuple[Annotated[ProbabilityRow, AfterValidator(_of_numbers)], ...] = Field(
        description="from the state of the row to that of the column"
    )
    dwell: Mapping[str, float] = Field(default={}, description="mean time of a visit (s)")

    @model_validator(mode="after")
    def _square(self) -> Self:
        require_square(self.states, self.matrix)
        unknown = {*self.endings, *self.dwell} - {*self.states}
        if unknown:
            raise ValueError(f"{', '.join(sorted(unknown))}: not among 'states'")
        return self


def require_square(states: tuple[str, ...], matrix: tuple[ProbabilityRow, ...]) -> None:
    """Refuse a matrix that does not have a row and a column for each state.

    Raises:
        ValueError: says what does not fit.
    """
    twice = sorted({state for state in states if states.count(state) > 1})
    if twice:
        raise ValueError(f"state {twice[0]!r} is named twice")
    if len(matrix) != len(states):
        raise ValueError(f"{len(states)} states need as many rows, got {len(matrix)}")
    for state, row in zip(states, matrix, strict=True):
        if len(row) != len(states):
            raise ValueError(
                f"the row of {state!r} needs {len(states)} entries, one for each state, "
                f"got {len(row)}"
            )
