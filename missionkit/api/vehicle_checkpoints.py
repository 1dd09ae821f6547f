"""Checkpoints of a flight with a vehicle, and resuming from them: it flew on without commands."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from missionkit.engine.clock import date
from missionkit.engine.flight_state import FlightState
from missionkit.engine.resume.resumption import Resumption
from missionkit.errors import UsageError
from missionkit.recorder import flight_track
from missionkit.recorder.checkpoint import Checkpoints, Loaded, load
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.flight_track import FlightTrack
from missionkit.recorder.record_sinks import Sink
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.command.control_authority import GIVEN_UP
from missionkit.vehicle.telemetry.observer import Datum


class Afield(NamedTuple):
    """Content of a checkpoint of a flight with a vehicle."""

    course: FlightState
    date: float  # s since 1970, when it was written
    datum: Datum
    lost: tuple[str, ...]  # what could not be saved, a sentence each
    track: FlightTrack  # what does not grow at every tick
    stamp: str  # of the mission that was flown
    link: str  # state of the link
    control: str  # state of control authority


class Before(NamedTuple):
    """Saved state from which a flight resumes."""

    loaded: Loaded
    saved: Afield
    track: FlightTrack
    changed: bool  # the mission is not the one that was flown


def before(folder: Path, stamp: str) -> Before:
    """Return the saved state from which the flight in a folder resumes.

    Args:
        folder: of the run.
        stamp: of the mission as it is now.

    Raises:
        UsageError: none of its checkpoints can be read, or it was no flight with a vehicle.
    """
    loaded = load(folder)
    saved = loaded.value
    if not isinstance(saved, Afield) or loaded.journals.keys() != {"ticks"}:
        raise UsageError(f"{folder / loaded.name}: this run was not flown with --vehicle")
    whole = flight_track.with_rows(saved.track, loaded.journals["ticks"])
    return Before(loaded, saved, whole, saved.stamp != stamp)


def woken(past: Before, vehicle: MavsdkVehicle, speed: float) -> Resumption:
    """Return the state to resume with, now that the vehicle has been reached.

    Mission time has advanced by the real gap. A clock that was set back counts as no gap.

    Args:
        past: the checkpoint, with the wall-clock date at which it was written.
        vehicle: connected; its observer gets the datum of the checkpoint back.
        speed: times real time, by which the gap in wall-clock time is multiplied.
    """
    saved = past.saved
    vehicle.observer.settle(saved.datum)
    gap = max(0.0, date() - saved.date) * speed
    notes = (*saved.lost, *_unusual(saved))
    return Resumption(saved.course, saved.course.memory.now + gap, past.changed, notes)


def _unusual(saved: Afield) -> tuple[str, ...]:
    """Return what was wrong with link and control when the checkpoint was written."""
    said = []
    if saved.link == "silent":
        said.append("the link was silent at the last checkpoint")
    if saved.control in GIVEN_UP:
        said.append(
            f"control had been given up at the last checkpoint ({saved.control}); resuming gives "
            "it back to the mission"
        )
    return tuple(said)


class VehicleCheckpointWriter:
    """Writes the checkpoints of one flight."""

    def __init__(
        self,
        folder: Path,
        vehicle: MavsdkVehicle,
        recorder: FlightRecorder,
        stamp: str,
        sink: Sink,
        past: Before | None = None,
    ) -> None:
        self._files = Checkpoints(folder, None if past is None else past.loaded)
        self._vehicle = vehicle
        self._recorder = recorder
        self._stamp = stamp
        self._sink = sink

    def __call__(self, course: FlightState, lost: tuple[str, ...]) -> None:
        """Write one."""
        seen, vehicle = self._recorder.track, self._vehicle
        ticks, track = len(seen.times), flight_track.without_rows(seen)
        states = vehicle.link_state, vehicle.control_state
        held = Afield(course, date(), vehicle.observer.datum, lost, track, self._stamp, *states)
        journals = {"ticks": lambda first: flight_track.rows(seen, first, ticks)}
        self._sink.put(lambda: self._files.save(held, journals))

    def forget(self) -> None:
        """Remove them: the flight has ended."""
        self._files.forget()
