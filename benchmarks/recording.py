"""Cost of the flight recorder."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.flights import Eyes, ready, warm_up
from benchmarks.measure import Table, seconds, spread
from missionkit.messages import Observation, Record
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.scenery import scenery_of
from missionkit.rehearsal.rehearse import rehearse

EYES: dict[Eyes, str] = {"corners": "without images", "rendered": "with images at 5 Hz"}


def tables() -> list[Table]:
    """Time the recorder at every tick of a precision task, and weigh its file."""
    warm_up()
    header = ("record", "ticks", "mean, us", "p50, us", "p99, us", "kB a second of flight")
    return [Table("Recorder", header, [_row(eyes) for eyes in EYES], "Processor time.")]


def _row(eyes: Eyes) -> tuple[str, ...]:
    at = ready(eyes)
    times: list[float] = []
    with TemporaryDirectory() as name:
        folder = Path(name)
        recorder = FlightRecorder(folder, camera=at.plan.camera, scenery=scenery_of(at.world))

        def write(record: Record, observation: Observation) -> None:
            frame, truth = observation.frame, at.vehicle.truth
            times.append(seconds(recorder.write, record, frame, truth))

        duration = rehearse(at, [write]).flown.duration
        recorder.close()
        size = (folder / "flight.mcap").stat().st_size
    mean = 1e6 * sum(times) / len(times)
    p50, p99 = spread(times, 1e6, 0)
    return EYES[eyes], str(len(times)), f"{mean:.0f}", p50, p99, f"{size / 1e3 / duration:.0f}"
