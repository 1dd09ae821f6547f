"""What a rehearsal was worth: its grade, the conditions of the mission, what rules success out."""

from __future__ import annotations

import math
from typing import NamedTuple

from missionkit.chart.checks.geofence_violations import outside
from missionkit.chart.model.mission_sections import Success
from missionkit.chart.semantics.requirement_watch import RequirementResult, results
from missionkit.engine.flight_end import FlightEnd, FlownFlight
from missionkit.engine.flight_history import FlightHistory, passed
from missionkit.engine.mission_success import (
    Condition,
    TruthSummary,
    conditions,
    flaws,
)
from missionkit.geometry import norm
from missionkit.messages import Observation, Record
from missionkit.perception.aruco import Aruco
from missionkit.rehearsal.stage import Stage
from missionkit.sim.flight_grading import (
    Grade,
    GradedVisit,
    in_flight,
    judge_visit,
    landed_at,
)
from missionkit.sim.simulators import graded
from missionkit.sim.world import Marker, World
from missionkit.sim.world_files import AnyWorld
from missionkit.states import VEHICLES


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


class Witness:
    """Tells the simulator which state the chart is in, and keeps what the flight went through."""

    def __init__(self, ready: Stage) -> None:
        self.passage = FlightHistory()
        self.estimate_error = 0.0  # m
        self._chart = ready.plan.chart
        self._vehicle = ready.vehicle
        self._state = ""

    def __call__(self, record: Record, _: Observation) -> None:
        """Take note of one tick."""
        if record.state != self._state:
            self._state = record.state
            self._vehicle.entered(record.state, record.now)
        self.passage = passed(self.passage, record, self._chart)
        truth = self._vehicle.truth
        if record.estimate.health.aligned and not truth.on_ground:
            error = norm(record.estimate.position - truth.position)
            self.estimate_error = max(self.estimate_error, error)


def graded_flight(ready: Stage, flown: FlownFlight, seen: Witness) -> Rehearsal:
    """Grade a flight by the truth.

    Args:
        ready: what flew.
        flown: how the flight went.
        seen: what it went through.
    """
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
        landing_error=None
        if place is None or _on_moving_deck(ready.world)
        else math.dist(place, landed_at(rows)),
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


def _on_moving_deck(world: AnyWorld) -> bool:
    """Say whether the place where it landed may have driven on since."""
    return isinstance(world, World) and world.deck is not None and world.deck.moves


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
