"""`summary.json`: the outcome of a run in one small file, for people and programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from missionkit.messages import Cycle
from missionkit.recorder.flight_track import FlightTrack
from missionkit.recorder.run_folder import write_whole
from missionkit.version import __version__

Outcome = Literal["success", "ended_safely", "crash"]


SUMMARY_FILE = "summary.json"


def outcome_text(outcome: str) -> str:
    """Return an outcome as a person would say it.

    >>> outcome_text("ended_safely")
    'ended safely'
    """
    return outcome.replace("_", " ")


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid")


class Stay(_Part):
    """One visit to a state."""

    state: str
    start: float  # s
    duration: float  # s


class StateChange(_Part):
    """One transition that was taken."""

    at: float  # s
    source: str
    to: str
    reason: str


class ConditionSummary(_Part):
    """One condition of success, and what came of it."""

    condition: str
    met: bool | None  # None: the ground truth is unknown
    figure: str


class RequirementSummary(_Part):
    """One requirement, and what came of it."""

    requirement: str
    fulfilled: bool | None  # None: undecided
    robustness: float | None  # in the unit of the guard that decides


class Spread(_Part):
    """How long something took over the run (ms)."""

    p50: float
    p99: float
    max: float


class Timing(_Part):
    """Wall-clock time of the parts of a tick."""

    sense: Spread
    process: Spread
    control: Spread
    total: Spread
    ticks: int
    overruns: int


class Summary(_Part):
    """Summary of a run on one page."""

    missionkit: str
    mission: str
    seed: int | None
    faults: tuple[str, ...]
    parameters: dict[str, Any]
    outcome: Outcome
    reason: str
    duration: float  # s, mission time
    states: tuple[Stay, ...]
    transitions: tuple[StateChange, ...]
    problems: tuple[str, ...]
    grade: dict[str, Any]
    conditions: tuple[ConditionSummary, ...] = ()
    requirements: tuple[RequirementSummary, ...] = ()
    timing: Timing | None
    record_hash: str

    @property
    def succeeded(self) -> bool:
        """Whether every condition of the mission was met."""
        return self.outcome == "success"


def summarise(
    track: FlightTrack,
    *,
    mission: str,
    outcome: Outcome,
    reason: str,
    seed: int | None = None,
    faults: Sequence[str] = (),
    parameters: Mapping[str, Any] | None = None,
    grade: Mapping[str, Any] | None = None,
    conditions: Sequence[tuple[str, bool | None, str]] = (),
    requirements: Sequence[tuple[str, bool | None, float | None]] = (),
    record_hash: str = "",
) -> Summary:
    """Sum up a run.

    Args:
        track: as the flight recorder kept it.
        mission: name of the mission.
        outcome: how it ended.
        reason: why it ended, one sentence.
        seed: of the simulator; `None` for a real flight.
        faults: injected, as written on the command line.
        parameters: of the mission file, after `--set`.
        grade: the simulator's judgement from ground truth.
        conditions: of success: the condition, whether it was met, the figure.
        requirements: name, whether it was fulfilled, robustness.
        record_hash: what closing the flight record returned.
    """
    return Summary(
        missionkit=__version__,
        mission=mission,
        seed=seed,
        faults=tuple(faults),
        parameters=dict(parameters or {}),
        outcome=outcome,
        reason=reason,
        duration=track.times[-1] - track.times[0] if track.times else 0.0,
        states=tuple(
            Stay(state=it.state, start=it.start, duration=it.end - it.start) for it in track.visits
        ),
        transitions=tuple(
            StateChange(at=at, source=it.source, to=it.to, reason=it.reason)
            for at, it in track.transitions
        ),
        problems=tuple(it.line() for it in track.problems),
        grade=dict(grade or {}),
        conditions=tuple(
            ConditionSummary(condition=says, met=met, figure=figure)
            for says, met, figure in conditions
        ),
        requirements=tuple(
            RequirementSummary(requirement=name, fulfilled=fulfilled, robustness=robustness)
            for name, fulfilled, robustness in requirements
        ),
        timing=timing_of(track.cycles),
        record_hash=record_hash,
    )


def timing_of(cycles: Sequence[Cycle]) -> Timing | None:
    """Return median, 99th percentile and maximum of each part; `None` when nothing was timed."""
    if not cycles:
        return None
    parts = np.array([(it.sense, it.process, it.control, it.total) for it in cycles])
    middle, late = np.percentile(1e3 * parts, (50, 99), axis=0)
    spreads = [
        Spread(p50=p50, p99=p99, max=top)
        for p50, p99, top in zip(
            middle.tolist(), late.tolist(), (1e3 * parts.max(axis=0)).tolist(), strict=True
        )
    ]
    sense, process, control, total = spreads
    return Timing(
        sense=sense,
        process=process,
        control=control,
        total=total,
        ticks=len(cycles),
        overruns=cycles[-1].overruns,
    )


def write_summary(folder: Path, summary: Summary) -> Path:
    """Write `summary.json` into a run's folder, whole or not at all."""
    path = folder / SUMMARY_FILE
    write_whole(path, summary.model_dump_json(indent=2) + "\n")
    return path


def read_summary(folder: Path) -> Summary:
    """Return the summary of a run.

    Raises:
        FileNotFoundError: the run left none.
    """
    text = (folder / SUMMARY_FILE).read_text(encoding="utf-8")
    return Summary.model_validate_json(text)
