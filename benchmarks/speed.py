"""Whole missions against real time."""

from __future__ import annotations

from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from benchmarks.flights import Eyes, ready, warm_up
from benchmarks.measure import Table, timed
from missionkit.messages import Observation, Record
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.scenery import scenery_of
from missionkit.rehearsal.grading import Rehearsal
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import Stage

REPEATS = 3
EYES: dict[Eyes, str] = {
    "rendered": "precision task, rendered camera",
    "corners": "precision task, corners without images",
    "none": "to the tree and back, no camera",
}
HEADER = ("mission", "recorder", "flown, s", "wall, s", "CPU, s", "x real time", "x on one core")


def tables() -> list[Table]:
    """Time every kind of mission with and without flight recorder."""
    warm_up()
    rows = [_row(eyes, recorded=recorded) for eyes in EYES for recorded in (False, True)]
    note = (
        f"Medians of {REPEATS} flights. x real time: mission time over wall time; x on one core: "
        "over processor time, which a busy machine does not lengthen."
    )
    return [Table("Speed", HEADER, rows, note)]


def _row(eyes: Eyes, *, recorded: bool) -> tuple[str, ...]:
    fly = _recorded if recorded else rehearse
    stages = [ready(eyes) for _ in range(REPEATS)]
    flights = [timed(fly, at) for at in stages]
    duration = flights[0][0].flown.duration
    wall = median(took.wall for _, took in flights)
    cpu = median(took.cpu for _, took in flights)
    return (
        EYES[eyes],
        "on" if recorded else "off",
        f"{duration:.0f}",
        f"{wall:.2f}",
        f"{cpu:.2f}",
        f"{duration / wall:.0f}",
        f"{duration / cpu:.0f}",
    )


def _recorded(at: Stage) -> Rehearsal:
    with TemporaryDirectory() as folder:
        scenery = scenery_of(at.world)
        with FlightRecorder(Path(folder), camera=at.plan.camera, scenery=scenery) as recorder:

            def write(record: Record, observation: Observation) -> None:
                recorder.write(record, observation.frame, at.vehicle.truth)

            return rehearse(at, [write])
