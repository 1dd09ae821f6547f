"""Outcome of a rehearsal, in one word and one sentence."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Literal

from missionkit.engine.flight_end import FlightEnd
from missionkit.engine.flight_history import FlightHistory
from missionkit.engine.mission_success import Condition
from missionkit.rehearsal.grading import Rehearsal
from missionkit.sim.flight_grading import Grade

Outcome = Literal["success", "ended_safely", "crash"]
LANDED = "landed"


def outcome(result: Rehearsal) -> Outcome:
    """Return how a flight ended."""
    if result.succeeded:
        return "success"
    on_ground = result.flown.end in {FlightEnd.NEVER_LEFT, FlightEnd.NOT_ARMED}
    never_left = on_ground and not result.grade.crashed
    return "ended_safely" if result.grade.landed or never_left else "crash"


def reason(result: Rehearsal, *, landing_requested: bool = False) -> str:
    """Return why it ended so.

    Args:
        result: of a flight.
        landing_requested: the operator requested a landing.
    """
    grade = result.grade
    if result.succeeded:
        return succeeded(result.passage)
    ended = safe_end(grade)
    if grade.crashed:
        return "hit an obstacle or the ground" if grade.docking is None else "hit the target"
    if result.flown.end is not FlightEnd.LANDED:
        return result.flown.says
    if result.flown.aborted:
        return aborted(landing_requested=landing_requested, ended=ended)
    if result.flaws:
        return f"not a success: {result.flaws[0]}"
    return missing(result.conditions, ended)


def safe_end(grade: Grade) -> str:
    """Return what a vehicle that ended safely has done, in a word or two."""
    if grade.docking is None:
        return LANDED
    return "docked" if grade.docking.docked else "holding clear"


def succeeded(passage: FlightHistory) -> str:
    """Return how a success came about: as planned, or past failsafes, which are named."""
    if not passage.failsafes:
        return "flown as planned"
    times = Counter(failsafe.label for failsafe in passage.failsafes)
    named = [label if count == 1 else f"{label} ({count} times)" for label, count in times.items()]
    return f"flown as planned, despite these failsafes: {'; '.join(named)}"


def missing(found: Sequence[Condition], ended: str = LANDED) -> str:
    """Return which conditions of success were not met; empty if all were."""
    unmet = [it for it in found if it.met is False]
    for it in unmet:
        if it.never:
            return unreached(it.never, ended)
    unmet_text = "; ".join(f"{it.says}: {it.figure}" for it in unmet)
    return f"{ended}, but conditions were not met: {unmet_text}" if unmet_text else ""


def aborted(*, landing_requested: bool, ended: str = LANDED) -> str:
    """Return why a flight ended that was ordered to land."""
    return f"{ended} because {'the operator requested it' if landing_requested else 'time ran out'}"


def unreached(visit: str, ended: str = LANDED) -> str:
    """Return why a flight ended that never was in the state that counts."""
    return f"{ended} without reaching {visit}"
