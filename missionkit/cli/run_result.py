"""Result of a run: outcome, reason, numbers, exit code."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from missionkit.chart.model.mission import Mission
from missionkit.chart.semantics.requirement_watch import STANDINGS
from missionkit.cli.run_options import RunOptions
from missionkit.errors import ExitCode, printable
from missionkit.outcome import outcome, reason
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.run_summary import Summary, outcome_text, summarise
from missionkit.rehearsal.grading import Rehearsal


def summed_up(
    order: RunOptions,
    mission: Mission,
    recorder: FlightRecorder,
    result: Rehearsal,
    *,
    landing_requested: bool,
) -> Summary:
    """Return the summary of a flight that has ended.

    Args:
        order: seed and faults.
        mission: with the parameters flown.
        recorder: closed here, for the hash of the record.
        result: of the flight, graded.
        landing_requested: whether someone stopped the run early.
    """
    return summarise(
        recorder.track,
        mission=mission.name,
        outcome=outcome(result),
        reason=reason(result, landing_requested=landing_requested),
        seed=order.seed,
        faults=order.faults,
        parameters=mission.params,  # with --set
        grade=result.grade.as_dict(),
        conditions=[it[:3] for it in result.conditions],
        requirements=result.requirements,
        record_hash=recorder.close(),
    )


def numbers(summary: Summary) -> str:
    """Return the flight in a line."""
    grade, timing = summary.grade, summary.timing
    parts = [summary.reason, f"{summary.duration:.0f} s"]
    if grade:
        parts.append(f"{grade['distance']:.0f} m flown")
    if grade.get("visit") is not None:
        parts.append(f"{_length(grade['visit']['position_error'])} from the goal on arrival")
    if grade.get("clearance") is not None:
        parts.append(f"clearance {grade['clearance']:.2f} m")
    if "herd" in grade:
        herd = grade["herd"]
        all_of_them = herd["home"] + herd["lost"] + herd["remaining"]
        parts.append(f"{herd['home']} of {all_of_them} robots home, {herd['lost']} lost")
    if timing is not None:
        parts.append(f"cycle p99 {timing.total.p99:.1f} ms")
    return ", ".join(parts)


def _length(metres: float) -> str:
    """Return a length as a person would say it.

    >>> _length(0.026), _length(40.589)
    ('2.6 cm', '40.6 m')
    """
    return f"{100.0 * metres:.1f} cm" if metres < 1.0 else f"{metres:.1f} m"


def report(order: RunOptions, summary: Summary, folder: Path) -> None:
    """Print the result for people, or as JSON.

    Args:
        order: says whether JSON is wanted.
        summary: of the flight.
        folder: of the run, named in the last line.
    """
    if order.as_json:
        print(json.dumps({**summary.model_dump(), "folder": str(folder)}, indent=2))  # noqa: T201
        return
    print(printable(f"{outcome_text(summary.outcome)}: {numbers(summary)}"))  # noqa: T201
    for line in lines(summary):
        print(printable(line))  # noqa: T201
    print(printable(str(folder)))  # noqa: T201


def lines(summary: Summary) -> Iterator[str]:
    """Yield conditions of success and requirements; over a vehicle each problem too."""
    words = {True: "met", False: "not met", None: "not known"}
    for it in summary.conditions:
        yield f"  {words[it.met]}: {it.condition} ({it.figure})"
    for each in summary.requirements:
        figure = "" if each.robustness is None else f" (robustness {each.robustness:.3g})"
        yield f"  {STANDINGS[each.fulfilled]}: requirement {each.requirement}{figure}"
    if not summary.grade:
        yield from (f"  problem at {problem}" for problem in summary.problems)


def exit_code(summary: Summary) -> ExitCode:
    """Return what the command says to the shell."""
    return {
        "success": ExitCode.SUCCESS,
        "ended_safely": ExitCode.ENDED_SAFELY,
        "crash": ExitCode.VEHICLE_LOST,
    }[summary.outcome]
