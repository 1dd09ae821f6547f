"""Flying a mission in the built-in simulator."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from missionkit.chart.catalogue import Catalogue
from missionkit.chart.load import load_model
from missionkit.chart.model import Mission
from missionkit.engine.clock import Pace
from missionkit.engine.flight import Plan, prepare
from missionkit.engine.loop import End, Flown, Observer, Operator, fly
from missionkit.messages import Observation, Record
from missionkit.perception.aruco import Aruco
from missionkit.sim.faults import Fault
from missionkit.sim.grade import Grade, grade
from missionkit.sim.vehicle import SimulatedVehicle
from missionkit.sim.warm_up import warm_up
from missionkit.sim.world import Marker, World


class Stage(NamedTuple):
    """Everything set up for one flight."""

    mission: Mission
    plan: Plan
    world: World
    vehicle: SimulatedVehicle


class Rehearsal(NamedTuple):
    """One flight, and what it was worth by ground truth."""

    flown: Flown
    grade: Grade

    @property
    def succeeded(self) -> bool:
        """Landed by itself, unhurt, and the mission's success was reached."""
        return self.flown.end is End.LANDED and not self.flown.aborted and self.grade.succeeded


def world_of(mission: Mission, folder: Path) -> World:
    """Return the world a mission names, or an empty one.

    Raises:
        FileError: the world file cannot be used.
    """
    return (
        World(world="empty") if mission.world is None else load_model(folder / mission.world, World)
    )


def stage(
    mission: Mission,
    catalogue: Catalogue,
    world: World,
    seed: int,
    faults: Sequence[Fault] = (),
) -> Stage:
    """Set up one flight; everything random comes from `seed`."""
    warm_up(corners=mission.camera.use == "corners")
    plan = prepare(mission, catalogue)
    return Stage(mission, plan, world, SimulatedVehicle(world, mission.camera, seed, faults))


def rehearse(
    ready: Stage,
    observers: Sequence[Observer] = (),
    *,
    operator: Operator | None = None,
    pace: Pace | None = None,
) -> Rehearsal:
    """Fly and grade."""
    visits = _Visits(ready.vehicle)
    flown = asyncio.run(
        fly(
            ready.plan,
            ready.vehicle,
            (visits, *observers),
            operator=operator,
            pace=pace,
            time_limit=ready.mission.settings.time_limit,
        )
    )
    return Rehearsal(flown, _graded(ready, visits))


class _Visits:
    """Tells the simulator which state the chart is in, and keeps when each was first entered."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self.spans: dict[str, tuple[float, float]] = {}
        self._vehicle = vehicle
        self._state = ""

    def __call__(self, record: Record, _: Observation) -> None:
        if record.state != self._state:
            self._state = record.state
            self._vehicle.entered(record.state, record.now)
        first, _last = self.spans.get(record.state, (record.now, record.now))
        self.spans[record.state] = (first, record.now)


def _graded(ready: Stage, visits: _Visits) -> Grade:
    success, rows = ready.mission.success, ready.vehicle.track.rows
    if success is None:
        return grade(rows)
    span = visits.spans.get(success.visit)
    if success.target is None:
        whole = grade(rows)
        return whole._replace(succeeded=whole.succeeded and span is not None)
    return grade(rows, success, _true_marker(ready, success.target), span)


def _true_marker(ready: Stage, target: str) -> Marker | None:
    """Return where the target's first marker really hangs."""
    for use in ready.mission.perception:
        detector = use.plugin
        if isinstance(detector, Aruco) and detector.target == target:
            return ready.world.marker(detector.id, detector.dictionary)
    return None
