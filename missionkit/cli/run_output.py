"""The folder of one run, new or resumed, and the files that are left there."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple, Protocol, TypeVar

from missionkit.api.flight_log import with_reports
from missionkit.api.journal_recording import JournaledFlight, journaled
from missionkit.api.run_origin import (
    Origin,
    Origins,
    forget_origin,
    keep_origin,
    stamp,
)
from missionkit.chart.model.mission import Mission
from missionkit.cli.run_options import RunOptions
from missionkit.cli.run_result import numbers
from missionkit.engine.prepared_mission import PreparedMission
from missionkit.errors import printable
from missionkit.recorder.checkpoint import Loaded
from missionkit.recorder.flight_journal import SIMULATOR
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.flight_track import FlightTrack
from missionkit.recorder.geographic_messages import Georeference
from missionkit.recorder.plot import draw
from missionkit.recorder.record_sinks import Reports, Sink
from missionkit.recorder.run_folder import (
    free_name,
    held,
    keep_mission,
    run_folder,
)
from missionkit.recorder.run_summary import Summary, outcome_text, write_summary
from missionkit.recorder.scenery import Scenery


class Past(Protocol):
    """Saved state from which a run resumes."""

    @property
    def loaded(self) -> Loaded:
        """The checkpoint."""

    @property
    def track(self) -> FlightTrack:
        """Track flown so far."""


P = TypeVar("P", bound=Past)


class Folder(NamedTuple):
    """Where a run leaves its files."""

    path: Path
    origin: Origin  # what the flight stands on

    @property
    def stamp(self) -> str:
        """A digest of what the flight stands on."""
        return stamp(self.origin)

    def journal(
        self, plan: PreparedMission, past: Past | None, sink: Sink, vehicle: str = SIMULATOR
    ) -> JournaledFlight:
        """Return the plan to fly and what keeps its journal.

        Args:
            plan: of the mission.
            past: the flight before a resume.
            sink: writes the journal.
            vehicle: address, or the simulator.
        """
        begins = past is None
        return journaled(self.path, plan, self.origin, sink, vehicle=vehicle, begins=begins)

    def recorder(
        self,
        plan: PreparedMission,
        scenery: Scenery,
        past: Past | None,
        sink: Sink,
        reference: Georeference,
    ) -> FlightRecorder:
        """Return what records the flight, beside the records that are there already.

        Args:
            plan: of which the camera is recorded.
            scenery: what is drawn around the flight.
            past: the flight before a resume, which goes first in the track.
            sink: gets everything that is recorded, as well as the file.
            reference: where on the earth and when it flies.
        """
        return FlightRecorder(
            self.path,
            camera=plan.camera,
            scenery=scenery,
            name=free_name(self.path, "flight.mcap"),
            past=None if past is None else past.track,
            known=plan.map,
            reference=reference,
            sink=sink,
        )

    def finish(
        self,
        summary: Summary,
        track: FlightTrack,
        scenery: Scenery,
        reports: Reports,
        forget: Callable[[], None],
    ) -> None:
        """Write the summary and the picture, and remove the checkpoints.

        What cannot be written is reported, and changes nothing about how the flight went.

        Args:
            summary: of the flight.
            track: for the picture.
            scenery: for the picture.
            reports: of what failed, in flight and here.
            forget: removes the checkpoints.
        """
        title = f"{summary.mission}: {outcome_text(summary.outcome)}"
        steps: dict[str, Callable[[], object]] = {
            "origin.json": lambda: forget_origin(self.path),
            "checkpoints": forget,
            "summary.json": lambda: write_summary(self.path, with_reports(summary, reports.all)),
            "track.png": lambda: draw(
                self.path / "track.png", track, scenery, title, numbers(summary)
            ),
        }
        for what, step in steps.items():
            try:
                step()
            except KeyboardInterrupt:
                reports.add(f"{self.path / what}", "interrupted", then="")
            except Exception as error:  # noqa: BLE001 - the flight has ended as it has ended
                reports.add(f"{self.path / what}", error, then="")
        with suppress(OSError):  # the terminal has gone too
            for sentence in reports.all:
                print(printable(sentence), file=sys.stderr)  # noqa: T201


@contextmanager
def folder_of(
    order: RunOptions,
    mission: Mission,
    origins: Origins,
    label: str,
    found: Callable[[Path, str], P],
) -> Iterator[tuple[Folder, P | None]]:
    """Hold the folder of a run, and what it resumes from, while this context is open.

    Args:
        order: of the command line.
        mission: that is flown.
        origins: of the run, and of the one it resumes.
        label: ends the name of a new folder.
        found: reads the checkpoint of a folder, given the stamp of the mission as it is now.

    Raises:
        UsageError: another process flies this run, or there is no checkpoint to resume from.
    """
    origin, before = origins
    path = order.resume or order.folder or run_folder(order.out, mission.name, label)
    with held(path):
        past = None
        if before is not None:
            past = found(path, stamp(origin))
            for wrong in past.loaded.wrong:
                print(printable(wrong), file=sys.stderr)  # noqa: T201
        if before != origin:
            keep_mission(path, order.mission)
            keep_origin(path, origin)
        yield Folder(path, origin), past
