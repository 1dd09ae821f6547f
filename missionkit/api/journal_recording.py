"""Keeping the journal of a flight: from the plan that flies to the file beside its record."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from missionkit.api.run_origin import Origin
from missionkit.engine.flight_state import FlightState
from missionkit.engine.prepared_mission import PreparedMission
from missionkit.messages import Observation, Record
from missionkit.perception.vision_recording import RecordedVision
from missionkit.recorder.flight_journal import (
    JOURNAL_FILE,
    SIMULATOR,
    VERSION,
    FlightJournal,
    JournalHead,
)
from missionkit.recorder.record_sinks import Sink
from missionkit.recorder.run_folder import free_name


class JournaledFlight(NamedTuple):
    """A plan whose images are kept, and the journal that keeps its ticks."""

    plan: PreparedMission
    journal: FlightJournal

    def observe(self, record: Record, observation: Observation) -> None:
        """Keep one tick; an observer of the flight."""
        self.journal.observe(record, observation)

    def keep(self, course: FlightState, record: Record) -> None:
        """Keep the memory of the flight; a keeper."""
        self.journal.keep(course.memory, record.now)


def journaled(
    folder: Path,
    plan: PreparedMission,
    origin: Origin,
    sink: Sink,
    *,
    vehicle: str = SIMULATOR,
    begins: bool = True,
) -> JournaledFlight:
    """Return what flies and keeps a journal in the folder of the run.

    Args:
        folder: of the run.
        plan: that is flown.
        origin: what the run stands on.
        sink: writes the journal.
        vehicle: address, or the simulator.
        begins: the flight is at its start, not resumed.
    """
    vision = RecordedVision(plan.eye)
    head = JournalHead(VERSION, origin, vehicle, begins, plan.arm_anyway)
    journal = FlightJournal(folder / free_name(folder, JOURNAL_FILE), head, vision.take, sink)
    return JournaledFlight(plan._replace(eye=vision), journal)
