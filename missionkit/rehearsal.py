"""Flying a mission in the built-in simulator."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from missionkit.chart.checks.geofence_violations import outside
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.mission_sections import Success
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.semantics.requirement_watch import RequirementResult, results
from missionkit.engine.clock import Pace
from missionkit.engine.flight_history import FlightHistory, passed
from missionkit.engine.flight_loop import (
    FlightEnd,
    FlownFlight,
    Keeper,
    Observer,
    Operator,
    fly,
    keep_nothing,
    no_reports,
)
from missionkit.engine.flight_state import FlightState
from missionkit.engine.mission_success import (
    Condition,
    TruthSummary,
    conditions,
    flaws,
)
from missionkit.engine.prepared_mission import PreparedMission, prepare
from missionkit.engine.resume.checkpoint_policy import now_and_then
from missionkit.engine.resume.resumption import Resumption
from missionkit.errors import UsageError
from missionkit.geometry import Mat, norm
from missionkit.messages import Observation, Record
from missionkit.perception.aruco import Aruco
from missionkit.recorder.scenery import RobotPath, Scenery
from missionkit.recorder.value_codec import is_plain
from missionkit.sim.fault_injection import Fault
from missionkit.sim.flight_grading import (
    Grade,
    GradedVisit,
    in_flight,
    judge_visit,
    landed_at,
)
from missionkit.sim.herd_grading import DrivenPath
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.simulators import Simulated, graded, simulated
from missionkit.sim.vehicle_snapshot import Snapshot, restore, taken
from missionkit.sim.world import Marker, World
from missionkit.sim.world_files import AnyWorld, load_world
from missionkit.states import VEHICLES


class Stage(NamedTuple):
    """Everything set up for one flight."""

    mission: Mission
    plan: PreparedMission
    world: AnyWorld
    vehicle: Simulated


class Rehearsal(NamedTuple):
    """One flight, and what it was worth by ground truth."""

    flown: FlownFlight
    grade: Grade
    conditions: tuple[Condition, ...] = ()  # of the mission's success
    flaws: tuple[str, ...] = ()  # what rules out a success, whatever the mission's conditions
    passage: FlightHistory = FlightHistory()
    requirements: tuple[RequirementResult, ...] = ()

    @property
    def succeeded(self) -> bool:
        """Landed undamaged where it meant to, and met every condition of the mission."""
        landed = self.flown.end is FlightEnd.LANDED and not self.flown.aborted and self.grade.landed
        return landed and not self.flaws and all(it.met for it in self.conditions)


class Kept(NamedTuple):
    """A flight under way, with the simulated vehicle that flies it; fit to be saved."""

    course: FlightState
    vehicle: Snapshot  # without its track
    passage: FlightHistory
    estimate_error: float  # m, largest so far
    lost: tuple[str, ...]  # what could not be saved, a sentence each


class Again(NamedTuple):
    """Saved state from which a rehearsal resumes."""

    kept: Kept
    track: Mat  # (N, TRACK_WIDTH), of the simulated vehicle
    gap: float  # s that the vehicle flew without commands
    changed: bool = False  # the mission is not the one that was flown

    @property
    def now(self) -> float:
        """Mission time (s) at which it resumes."""
        return self.kept.course.memory.now + self.gap


def world_of(mission: Mission, folder: Path) -> AnyWorld:
    """Return the world a mission names, or an empty one.

    Raises:
        FileError: the world file cannot be used, or is that of another kind of vehicle.
        UsageError: there is none, and the kind of vehicle needs one.
    """
    kind = mission.vehicle.use
    if mission.world is None:
        if kind != "sim":
            raise UsageError(f"a mission of a {kind} needs a world: add `world: worlds/NAME.yaml`")
        return World(world="empty")
    return load_world(folder / mission.world, kind, mission.place("world"))


def world_over_mavlink(mission: Mission, folder: Path) -> World:
    """Return the world of a mission that is flown over MAVLink, for the camera that is drawn.

    Raises:
        FileError: the world file cannot be used.
        UsageError: no autopilot flies this kind of vehicle.
    """
    kind = VEHICLES[mission.vehicle.use]
    if not kind.over_mavlink:
        raise UsageError(f"a {kind.name} flies in the simulator only: leave its address out")
    world = world_of(mission, folder)
    assert isinstance(world, World)  # noqa: S101 - of what an autopilot flies
    return world


def stage(
    mission: Mission,
    catalogue: Catalogue,
    world: AnyWorld,
    seed: int,
    faults: Sequence[Fault] = (),
) -> Stage:
    """Set up one flight; everything random comes from `seed`.

    Args:
        mission: to fly.
        catalogue: of plug-ins.
        world: to fly in.
        seed: of everything random.
        faults: to inject.

    Raises:
        UsageError: the vehicle would start off the mission's map or in one of its walls.
    """
    known = mission.known
    wrong = "" if known is None or not isinstance(world, World) else known.unfit_start(world.start)
    if wrong and isinstance(world, World):
        north, east = world.start
        raise UsageError(f"world {world.world!r}: it starts at ({north:g}, {east:g}), {wrong}")
    vehicle = simulated(world, mission.camera, seed, faults)
    return Stage(mission, prepare(mission, catalogue), world, vehicle)


def rehearse(
    ready: Stage,
    observers: Sequence[Observer] = (),
    *,
    operator: Operator | None = None,
    pace: Pace | None = None,
    save: Callable[[Kept], None] | None = None,
    reports: Callable[[], tuple[str, ...]] = no_reports,
    again: Again | None = None,
) -> Rehearsal:
    """Fly and grade.

    Args:
        ready: the flight, set up afresh even when it resumes.
        observers: called after every tick.
        operator: may request a landing.
        pace: lets mission time pass; as fast as possible by default.
        save: called at every transition and once a second with the state to resume from.
        reports: what failed beside the flight since the last call; joins the problems.
        again: the saved state to resume from.
    """
    visits = _Witness(ready)
    resume = None if again is None else _restored(ready, visits, again)
    keeper = keep_nothing if save is None else _keeping(ready, visits, save)
    flown: list[FlownFlight] = []

    async def flight() -> None:  # returns nothing: asyncio would write it all out as text
        flown.append(
            await fly(
                ready.plan,
                ready.vehicle,
                (visits, *observers),
                operator=operator,
                pace=pace,
                time_limit=ready.mission.settings.time_limit,
                keeper=keeper,
                reports=reports,
                resume=resume,
            )
        )

    asyncio.run(flight())
    return _graded(ready, flown[0], visits)


def _restored(ready: Stage, visits: _Witness, again: Again) -> Resumption:
    """Restore the vehicle, and let it fly on alone, without listening to it."""
    ready.vehicle.track.restore(again.track)
    restore(ready.vehicle, again.kept.vehicle)
    visits.passage = again.kept.passage
    visits.estimate_error = again.kept.estimate_error
    if again.gap > 0.0:
        ready.vehicle.advance(again.now)
    return Resumption(again.kept.course, again.now, again.changed, again.kept.lost)


def _keeping(ready: Stage, visits: _Witness, save: Callable[[Kept], None]) -> Keeper:
    """Return what saves it together with the simulated vehicle."""

    def keep(course: FlightState, lost: tuple[str, ...]) -> None:
        save(Kept(course, taken(ready.vehicle), visits.passage, visits.estimate_error, lost))

    return now_and_then(ready.plan.chart, is_plain, keep)


def with_paths(scenery: Scenery, vehicle: Simulated) -> Scenery:
    """Return the scenery with the paths that ground robots drove, since the run was resumed.

    Args:
        scenery: of the world.
        vehicle: that was flown there.
    """
    if not isinstance(vehicle, SimulatedVehicle):
        return scenery
    return scenery._replace(paths=tuple(map(_robot_path, vehicle.herd.driven())))


def _robot_path(driven: DrivenPath) -> RobotPath:
    return RobotPath(driven.places, "obstacle" if driven.obstacle else "target", driven.end)


class _Witness:
    """Tells the simulator which state the chart is in, and keeps what the flight went through."""

    def __init__(self, ready: Stage) -> None:
        self.passage = FlightHistory()
        self.estimate_error = 0.0  # m
        self._chart = ready.plan.chart
        self._vehicle = ready.vehicle
        self._state = ""

    def __call__(self, record: Record, _: Observation) -> None:
        if record.state != self._state:
            self._state = record.state
            self._vehicle.entered(record.state, record.now)
        self.passage = passed(self.passage, record, self._chart)
        truth = self._vehicle.truth
        if record.estimate.health.aligned and not truth.on_ground:
            error = norm(record.estimate.position - truth.position)
            self.estimate_error = max(self.estimate_error, error)


def _graded(ready: Stage, flown: FlownFlight, seen: _Witness) -> Rehearsal:
    rows, wanted, passage = ready.vehicle.track.rows, ready.mission.success, seen.passage
    visits = {
        one.visit: _visit(ready, one, one.target, passage.spans.get(one.visit))
        for one in wanted
        if one.visit is not None and one.target is not None
    }
    place = passage.landing
    result = graded(ready.vehicle)._replace(
        visit=next((visit for visit in visits.values() if visit is not None), None),
        estimate_error=seen.estimate_error,
        outside_fence=outside(ready.mission, in_flight(rows)),
        landing_error=None if place is None else math.dist(place, landed_at(rows)),
    )
    errors = {
        state: None
        if visit is None
        else (
            visit.position_error,
            None if visit.yaw_error is None else math.degrees(visit.yaw_error),
        )
        for state, visit in visits.items()
    }
    truth = TruthSummary(
        errors,
        result.clearance,
        result.touched_at,
        seen.estimate_error,
        result.outside_fence or 0.0,
        result.landing_error,
        *_docking(result),
        None if result.herd is None else result.herd.home,
    )
    found = conditions(wanted, passage, truth)
    wrong = flaws(wanted, passage, truth, VEHICLES[ready.mission.vehicle.use])
    met = result.landed and all(it.met for it in found)
    came = results(ready.plan.chart.watch.requirements, flown.memory.chart.monitors)
    return Rehearsal(flown, result._replace(succeeded=met), found, wrong, passage, came)


def _docking(result: Grade) -> tuple[bool, tuple[float, float] | None]:
    """Return whether a free flyer docked, and how far (m, deg) from the docked pose."""
    it = result.docking
    if it is None:
        return False, None
    return it.docked, (it.position_error, math.degrees(it.attitude_error))


def _visit(
    ready: Stage, one: Success, target: str, span: tuple[float, float] | None
) -> GradedVisit | None:
    marker = _true_marker(ready, target)
    if marker is None or span is None:
        return None
    return judge_visit(ready.vehicle.track.rows, marker, one.standoff, span)


def _true_marker(ready: Stage, target: str) -> Marker | None:
    """Return where the target's first marker really hangs."""
    if not isinstance(ready.world, World):
        return None
    for use in ready.mission.perception:
        detector = use.plugin
        if isinstance(detector, Aruco) and detector.target == target:
            return ready.world.marker(detector.id, detector.dictionary)
    return None
