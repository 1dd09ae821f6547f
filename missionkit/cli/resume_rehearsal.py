"""`missionkit run --resume RUN`: going on with a flight whose process died."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from missionkit.errors import UsageError
from missionkit.recorder import flight_track
from missionkit.recorder.checkpoint import Checkpoints, Loaded, load
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.flight_track import FlightTrack
from missionkit.recorder.record_sinks import Sink
from missionkit.rehearsal.rehearse import Again, Kept
from missionkit.rehearsal.stage import Stage


class Contents(NamedTuple):
    """Content of a checkpoint of a run."""

    kept: Kept
    track: FlightTrack  # what does not grow at every tick
    stamp: str  # of the mission that was flown


class Since(NamedTuple):
    """Saved state from which a run resumes."""

    loaded: Loaded
    again: Again
    track: FlightTrack


def since(folder: Path, gap: float, stamp: str) -> Since:
    """Return the saved state of the run in a folder. The mission's plug-ins are loaded already.

    Args:
        folder: of the run.
        gap: s that the vehicle flew alone.
        stamp: of the mission as it is now.

    Raises:
        UsageError: none of its checkpoints can be read.
    """
    loaded = load(folder)
    contents = loaded.value
    if not isinstance(contents, Contents) or loaded.journals.keys() != {"truth", "ticks"}:
        raise UsageError(f"{folder / loaded.name}: this is not the checkpoint of a flight")
    changed = contents.stamp != stamp
    again = Again(contents.kept, loaded.journals["truth"], gap, changed)
    return Since(loaded, again, flight_track.with_rows(contents.track, loaded.journals["ticks"]))


class RehearsalCheckpointWriter:
    """Writes the checkpoints of one run."""

    def __init__(
        self,
        folder: Path,
        ready: Stage,
        recorder: FlightRecorder,
        stamp: str,
        sink: Sink,
        before: Since | None = None,
    ) -> None:
        self._files = Checkpoints(folder, None if before is None else before.loaded)
        self._vehicle = ready.vehicle
        self._recorder = recorder
        self._stamp = stamp
        self._sink = sink

    def __call__(self, kept: Kept) -> None:
        """Write one."""
        seen, truth = self._recorder.track, self._vehicle.track.rows
        ticks = len(seen.times)
        held = Contents(kept, flight_track.without_rows(seen), self._stamp)
        journals = {
            "truth": lambda first: truth[first:],
            "ticks": lambda first: flight_track.rows(seen, first, ticks),
        }
        self._sink.put(lambda: self._files.save(held, journals))

    def forget(self) -> None:
        """Remove them: the flight has ended."""
        self._files.forget()
