"""One run of a campaign: its order and its results."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

from pydantic import BaseModel, ConfigDict

Outcome = Literal["success", "ended_safely", "crash", "error", "hung", "lost"]

NO_FLIGHT = ("error", "hung", "lost")  # the run says nothing of the mission


class RunOrder(NamedTuple):
    """Settings that all runs of a campaign share; sent to every worker."""

    mission: str  # path
    settings: Mapping[str, str]
    plugins: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()
    events: tuple[str, ...] = ()  # of the operator, NAME@WHEN
    records: str = ""  # folder for flight records; none without


class Case(NamedTuple):
    """One run to be flown."""

    number: int  # counts all runs of the campaign
    variant: int
    seed: int
    settings: Mapping[str, str]  # of the variant, beside those of the order


class Row(BaseModel):
    """One run that has ended."""

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid")

    number: int
    variant: int
    seed: int
    settings: dict[str, str]  # of the variant
    outcome: Outcome
    reason: str
    parameters: dict[str, Any] = {}  # of the mission, all of them
    conditions: dict[str, bool | None] = {}  # of success: whether it was met
    requirements: dict[str, tuple[bool | None, float | None]] = {}  # fulfilled, robustness
    metrics: dict[str, float | None] = {}
    times: dict[str, float] = {}  # s in each state, those around the active one included
    transitions: dict[str, int] = {}  # "gps -> visual": how often
    ways: dict[str, int] = {}  # "gps -> visual: when marker-sure": how often, by its reason
    entries: dict[str, int] = {}  # how often each state was entered, those around included
    visits: tuple[tuple[str, float], ...] = ()  # states that commanded, in order, and s in each
    problems: tuple[str, ...] = ()

    @property
    def succeeded(self) -> bool:
        """Whether the mission was flown with success."""
        return self.outcome == "success"

    @property
    def flew(self) -> bool:
        """Whether the run says something of the mission: it neither hung nor broke."""
        return self.outcome not in NO_FLIGHT


def unflown(case: Case, outcome: Outcome, reason: str) -> Row:
    """Return the row of a run that gave no result.

    Args:
        case: the order that was not carried out.
        outcome: what the run counts as.
        reason: one sentence for the report.
    """
    return Row(
        number=case.number,
        variant=case.variant,
        seed=case.seed,
        settings=dict(case.settings),
        outcome=outcome,
        reason=reason,
    )
