"""Results of a flight from Python: its track in memory and, in a folder, its record."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

from missionkit.api.journal_recording import JournaledFlight, journaled
from missionkit.api.run_origin import Origin, forget_origin
from missionkit.api.vehicle_checkpoints import VehicleCheckpointWriter
from missionkit.engine.flight_loop import Keeper, Observer, keep_nothing
from missionkit.engine.prepared_mission import PreparedMission
from missionkit.errors import UsageError
from missionkit.messages import Observation, Record
from missionkit.recorder import flight_track as tracks
from missionkit.recorder.flight_journal import SIMULATOR
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.flight_track import FlightTrack
from missionkit.recorder.geographic_messages import Georeference
from missionkit.recorder.plot import draw
from missionkit.recorder.record_sinks import (
    CHECKPOINTS,
    JOURNAL,
    RECORD,
    Sinks,
    contained,
)
from missionkit.recorder.run_folder import keep_mission
from missionkit.recorder.run_summary import Summary, outcome_text, write_summary
from missionkit.recorder.scenery import Scenery
from missionkit.sim.ground_truth import TrueState

LOG_FILE = "flight.mcap"


class Logbook:
    """Keeps a flight's track; given a folder, leaves record, summary and picture there.

    Args:
        folder: is made if need be; None: nothing is written.
        plan: that is flown.
        scenery: what stands around.
        sinks: take what is written, and reports of what fails.
        mission: path of the file that is flown, copied into the folder.
        origin: what the flight stands on, for its journal.
        reference: where on the earth and when it flies.
        vehicle: address, or the simulator.

    Raises:
        UsageError: the folder holds a flight record already.
    """

    def __init__(
        self,
        folder: str | Path | None,
        plan: PreparedMission,
        scenery: Scenery,
        sinks: Sinks,
        mission: Path,
        origin: Origin,
        reference: Georeference | None = None,
        vehicle: str = SIMULATOR,
    ) -> None:
        self.digest = ""
        self.plan = plan  # to fly: its images are kept for the journal
        self.keep: Keeper = keep_nothing
        self._journaled: JournaledFlight | None = None
        self.folder = None if folder is None else Path(folder)
        self._sinks = sinks
        self.scenery = scenery
        self._track = tracks.begin()
        self.recorder: FlightRecorder | None = None
        if self.folder is not None:
            self.folder.mkdir(parents=True, exist_ok=True)
            if (self.folder / LOG_FILE).exists():
                raise UsageError(
                    f"{self.folder}: already holds a flight record: choose another name"
                )
            keep_mission(self.folder, mission)
            kept = journaled(self.folder, plan, origin, sinks.journal, vehicle=vehicle)
            self._journaled, self.plan, self.keep = kept, kept.plan, kept.keep
            self.recorder = FlightRecorder(
                self.folder,
                camera=plan.camera,
                scenery=self.scenery,
                known=plan.map,
                reference=reference,
                sink=sinks.record,
            )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self.recorder is not None:
            self.digest = self.recorder.close()
        if self._journaled is not None:
            self._journaled.journal.close()
        self._sinks.close()

    @property
    def track(self) -> FlightTrack:
        """Track of the flight: positions, states, transitions."""
        return self._track if self.recorder is None else self.recorder.track

    def observing(
        self, observers: Sequence[Observer], truth: Callable[[], TrueState | None] = lambda: None
    ) -> tuple[Observer, ...]:
        """Return observers that keep the flight, then call others; nothing they raise ends it.

        Args:
            observers: of the caller.
            truth: of a simulated vehicle.
        """

        def keep(record: Record, observation: Observation) -> None:
            if self.recorder is None:
                tracks.add(self._track, record, truth())
            else:
                self.recorder.write(record, observation.frame, truth())

        reports = self._sinks.reports
        named = [(RECORD, keep), *((f"observer {n}", it) for n, it in enumerate(observers, 1))]
        if self._journaled is not None:
            named.insert(1, (JOURNAL, self._journaled.observe))
        return tuple(contained(what, call, reports) for what, call in named)

    def finished(
        self, summary: Summary, checkpoints: VehicleCheckpointWriter | None = None
    ) -> Summary:
        """Leave summary and picture; return the summary with all that failed beside the flight.

        Args:
            summary: of the flight.
            checkpoints: are removed: the flight has ended, and cannot be resumed.
        """
        reports = self._sinks.reports
        if self.folder is not None and checkpoints is not None:
            contained("origin.json", forget_origin, reports)(self.folder)
            contained(CHECKPOINTS, checkpoints.forget, reports)()
        summary = with_reports(summary, reports.all)
        if self.folder is not None:
            title = f"{summary.mission}: {outcome_text(summary.outcome)}"
            contained("track.png", draw, reports)(
                self.folder / "track.png", self.track, self.scenery, title, summary.reason
            )
            write_summary(self.folder, summary)
        return summary


def with_reports(summary: Summary, reports: Sequence[str]) -> Summary:
    """Return a summary whose problems name all that failed beside the flight."""
    known = [problem.partition(": ")[2] for problem in summary.problems]
    late = tuple(it for it in reports if it not in known)
    return summary.model_copy(update={"problems": (*summary.problems, *late)})
