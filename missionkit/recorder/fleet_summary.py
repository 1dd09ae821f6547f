"""`fleet.json`: what became of the vehicles of a fleet, and how near they came to each other."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict

from missionkit.recorder.run_folder import write_whole
from missionkit.recorder.run_summary import outcome_text
from missionkit.version import __version__

MemberOutcome = Literal["success", "ended_safely", "crash", "lost"]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid")


class MemberSummary(_Part):
    """One vehicle; its own folder says more."""

    vehicle: str
    mission: str
    outcome: MemberOutcome  # lost: its flight broke off
    reason: str


class EncounterSummary(_Part):
    """How near two vehicles came to each other while both were in the air."""

    first: str
    second: str
    least: float  # m
    at: float  # s, from the start of the fleet
    conflicts: int  # times that they came nearer than the separation
    duration: float  # s, of those

    def line(self) -> str:
        """Return the encounter as a sentence."""
        times = "once" if self.conflicts == 1 else f"{self.conflicts} times"
        came = f"in conflict {times}, {self.duration:.1f} s" if self.conflicts else "no conflict"
        return (
            f"{self.first} and {self.second}: {self.least:.1f} m apart at least, "
            f"at {self.at:.1f} s; {came}"
        )


class FleetSummary(_Part):
    """Summary of a fleet on one page."""

    missionkit: str = __version__
    seed: int | None
    vehicles: tuple[MemberSummary, ...]
    separation: float  # m, nearer than which two vehicles are in conflict
    measured_by: Literal["ground truth", "reports"]
    encounters: tuple[EncounterSummary, ...]
    collisions: tuple[tuple[float, str, str], ...] = ()  # s, and both names

    @property
    def conflicts(self) -> int:
        """Conflicts of all pairs."""
        return sum(it.conflicts for it in self.encounters)

    def lines(self) -> Iterator[str]:
        """Yield the lines that are printed."""
        for it in self.vehicles:
            yield f"{it.vehicle}: {outcome_text(it.outcome)}: {it.reason}"
        for encounter in self.encounters:
            yield f"  {encounter.line()}"
        for at, first, second in self.collisions:
            yield f"  {first} and {second} collided at {at:.1f} s"
        if self.encounters:
            yield f"  (conflict: nearer than {self.separation:g} m, by {self.measured_by})"


def write_fleet_summary(folder: Path, summary: FleetSummary) -> Path:
    """Write `fleet.json` into the folder of a fleet; return its path."""
    path = folder / "fleet.json"
    write_whole(path, summary.model_dump_json(indent=2) + "\n")
    return path
