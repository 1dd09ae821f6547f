"""What a rehearsal came to, in one word and one sentence."""

from __future__ import annotations

from collections.abc import Container
from typing import Literal

from missionkit.chart.model.mission import Mission
from missionkit.chart.model.sections import Success
from missionkit.engine.loop import End
from missionkit.rehearsal import Rehearsal

Outcome = Literal["success", "ended_safely", "crash"]


def outcome(result: Rehearsal) -> Outcome:
    """Return how a flight ended."""
    if result.succeeded:
        return "success"
    on_ground = result.flown.end in {End.NEVER_LEFT, End.NOT_ARMED}
    never_left = on_ground and not result.grade.crashed
    return "ended_safely" if result.grade.landed or never_left else "crash"


def reason(
    mission: Mission, result: Rehearsal, visited: Container[str], *, asked: bool = False
) -> str:
    """Return why it ended so.

    Args:
        mission: that was flown.
        result: of its flight.
        visited: the states it was in.
        asked: the operator asked for a landing.
    """
    grade = result.grade
    if result.succeeded:
        return "flown as planned"
    if grade.crashed:
        return "hit an obstacle or the ground"
    if result.flown.end is not End.LANDED:
        return result.flown.says
    if result.flown.aborted:
        return aborted(asked=asked)
    if mission.success is not None and grade.visit is None:
        return _unreached(mission.success, visited)
    return "landed, but the goal was missed by more than allowed"


def _unreached(success: Success, visited: Container[str]) -> str:
    if success.visit not in visited:
        return unreached(success.visit)
    return f"landed, but the world has no marker of {success.target} to measure the goal by"


def aborted(*, asked: bool) -> str:
    """Return why a flight ended that was told to land."""
    return f"landed because {'the operator asked for it' if asked else 'time ran out'}"


def unreached(visit: str) -> str:
    """Return why a flight ended that never was in the state that counts."""
    return f"landed without reaching {visit}"
