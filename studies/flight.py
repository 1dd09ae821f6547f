"""One flight of a study, and many of them in parallel."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Literal, NamedTuple

from missionkit.chart.load import load
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.flight_end import FlightEnd
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import Stage, stage, world_of
from missionkit.sim.fault_injection import parse_fault
from missionkit.sim.flight_grading import Grade
from missionkit.sim.world import World
from studies.clearance import on_the_way
from studies.parallel import in_parallel
from studies.watch import Change, Sample, Watch

MISSION = Path(__file__).parents[1] / "missions" / "precision_task.yaml"
Camera = Literal["rendered", "corners"]


class Order(NamedTuple):
    """One flight to be flown."""

    seed: int
    camera: Camera
    faults: tuple[str, ...] = ()


class Outcome(StrEnum):
    """Outcome of a flight."""

    FINISHED = "succeeded, work finished"
    UNFINISHED = "succeeded, work unfinished"
    SAFE = "landed unhurt without success"
    HURT = "hit something or did not come down"


class Run(NamedTuple):
    """One flight in plain values, small enough to come back from a worker."""

    order: Order
    end: FlightEnd
    succeeded: bool
    grade: Grade
    passed: float  # m, least clearance from obstacles on the way, see `on_the_way`
    charge: float  # 0 to 1, left at the end
    changes: tuple[Change, ...]
    problems: tuple[str, ...]
    samples: tuple[Sample, ...]

    @property
    def outcome(self) -> Outcome:
        """Outcome; `succeeded` alone does not say whether the work was finished."""
        if self.succeeded:
            worked = any((it.source, it.to) == ("task", "return") for it in self.changes)
            return Outcome.FINISHED if worked else Outcome.UNFINISHED
        return Outcome.SAFE if self.grade.landed else Outcome.HURT

    @property
    def path(self) -> str:
        """The states in the order they were entered."""
        return " → ".join(change.to for change in self.changes)

    def entered(self, state: str) -> float | None:
        """Return when a state was first entered (s)."""
        return next((change.at for change in self.changes if change.to == state), None)

    def stays(self, state: str) -> list[float]:
        """Return how long (s) each completed stay in a state lasted."""
        pairs = zip(self.changes, self.changes[1:], strict=False)
        return [left.at - come.at for come, left in pairs if come.to == state]


def setting() -> tuple[Mission, World]:
    """Return the mission of the study and its world."""
    mission = load(MISSION, builtin())
    return mission, world_of(mission, MISSION.parent)


def staged(order: Order) -> Stage:
    """Set up one flight."""
    mission, world = setting()
    camera = mission.camera.model_copy(update={"use": order.camera})
    mission = mission.model_copy(update={"camera": camera})
    faults = [parse_fault(text) for text in order.faults]
    return stage(mission, builtin(), world, order.seed, faults)


def fly(order: Order) -> Run:
    """Fly once."""
    ready = staged(order)
    watch = Watch(ready)
    try:
        result = rehearse(ready, [watch])
    except Exception as error:
        error.add_note(f"in {order}")
        raise
    passed = on_the_way(ready.world, watch.marker, ready.vehicle.track.rows[:, 1:4])
    return Run(
        order,
        result.flown.end,
        result.succeeded,
        result.grade,
        passed,
        ready.vehicle.truth.charge,
        tuple(watch.changes),
        tuple(watch.problems),
        tuple(watch.samples),
    )


def fly_all(orders: Sequence[Order], workers: int) -> Iterator[Run]:
    """Fly each order, in order, `workers` at a time; with one worker in this process."""
    return in_parallel(fly, orders, workers)
