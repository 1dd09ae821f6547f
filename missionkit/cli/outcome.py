"""What a flight came to: outcome, reason, numbers, exit code."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from missionkit.chart.model.mission import Mission, Success
from missionkit.cli.order import Order
from missionkit.engine.loop import End
from missionkit.errors import ExitCode
from missionkit.recorder.flight import FlightRecorder
from missionkit.recorder.summary import Summary, summarise
from missionkit.recorder.track import Track
from missionkit.rehearsal import Rehearsal


def summed_up(
    order: Order, mission: Mission, recorder: FlightRecorder, result: Rehearsal, *, asked: bool
) -> Summary:
    """Return the summary of a flight that has ended."""
    return summarise(
        recorder.track,
        mission=mission.name,
        outcome="success" if result.succeeded else _failure(result),
        reason=_reason(mission, result, recorder.track, asked=asked),
        seed=order.seed,
        faults=order.faults,
        parameters=mission.params,  # with --set
        grade=result.grade.as_dict(),
        record_hash=recorder.close(),
    )


def _failure(result: Rehearsal) -> Any:
    never_left = result.flown.end is End.NEVER_LEFT and not result.grade.crashed
    return "ended_safely" if result.grade.landed or never_left else "crash"


def _reason(mission: Mission, result: Rehearsal, track: Track, *, asked: bool) -> str:
    grade = result.grade
    if result.succeeded:
        return "flown as planned"
    if grade.crashed:
        return "hit an obstacle or the ground"
    if result.flown.end is not End.LANDED:
        return str(result.flown.end)
    if result.flown.aborted:
        return f"landed because {'the operator asked for it' if asked else 'time ran out'}"
    if mission.success is not None and grade.visit is None:
        return _unreached(mission.success, track)
    return "landed, but the goal was missed by more than allowed"


def _unreached(success: Success, track: Track) -> str:
    if success.visit not in {visit.state for visit in track.visits}:
        return f"landed without reaching {success.visit}"
    return f"landed, but the world has no marker of {success.target} to measure the goal by"


def numbers(summary: Summary) -> str:
    """Return the flight in a line."""
    grade, timing = summary.grade, summary.timing
    parts = [summary.reason, f"{summary.duration:.0f} s"]
    if grade:
        parts.append(f"{grade['distance']:.0f} m flown")
    if grade.get("visit") is not None:
        error = 100.0 * grade["visit"]["position_error"]
        parts.append(f"{error:.1f} cm from the goal on arrival")
    if grade.get("clearance") is not None:
        parts.append(f"clearance {grade['clearance']:.2f} m")
    if timing is not None:
        parts.append(f"cycle p99 {timing.total.p99:.1f} ms")
    return ", ".join(parts)


def report(order: Order, summary: Summary, folder: Path) -> None:
    """Tell the person at the terminal, or the program that asked for JSON."""
    if order.as_json:
        print(json.dumps({**summary.model_dump(), "folder": str(folder)}, indent=2))  # noqa: T201
        return
    print(f"{summary.outcome}: {numbers(summary)}\n{folder}")  # noqa: T201


def exit_code(summary: Summary) -> ExitCode:
    """Return what the command says to the shell."""
    return {
        "success": ExitCode.SUCCESS,
        "ended_safely": ExitCode.ENDED_SAFELY,
        "crash": ExitCode.VEHICLE_LOST,
    }[summary.outcome]
