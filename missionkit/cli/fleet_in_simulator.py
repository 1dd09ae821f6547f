"""`missionkit fleet` in the built-in simulator: all vehicles in one process, in lockstep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path

from missionkit.api.flight_log import Logbook
from missionkit.api.interrupts import landing_on_interrupt
from missionkit.api.run_origin import origin_of_loaded
from missionkit.api.simulation import fault_of
from missionkit.cli.fleet_members import FleetOptions, Member
from missionkit.engine.clock import RealTime, date
from missionkit.engine.flight_loop import Operator
from missionkit.outcome import outcome, reason
from missionkit.recorder.fleet_summary import EncounterSummary, FleetSummary, MemberSummary
from missionkit.recorder.geographic_messages import Georeference
from missionkit.recorder.record_sinks import inline
from missionkit.recorder.run_summary import summarise
from missionkit.recorder.scenery import scenery_of
from missionkit.rehearsal.fleet import FleetFlight, check_fit, member_seed, rehearse_fleet
from missionkit.rehearsal.grading import Rehearsal
from missionkit.rehearsal.stage import Stage, stage, world_of
from missionkit.sim.ground_truth import TrueState


def staged(members: Sequence[Member], seed: int, *, anyway: bool = False) -> dict[str, Stage]:
    """Set up all vehicles.

    Args:
        members: missions and faults.
        seed: of everything random.
        anyway: take off although a failsafe holds on the ground.

    Raises:
        FileError: a world cannot be used.
        UsageError: a fault does not fit, or the vehicles cannot fly together.
    """
    stages = {}
    for number, member in enumerate(members):
        model, catalogue = member.mission.model, member.mission.catalogue
        world = world_of(model, member.mission.path.parent)
        faults = [fault_of(text, model, world) for text in member.faults]
        ready = stage(model, catalogue, world, member_seed(seed, number), faults)
        stages[member.name] = ready._replace(plan=ready.plan._replace(arm_anyway=anyway))
    check_fit(stages)
    return stages


def fly_in_simulator(
    wanted: FleetOptions, members: Sequence[Member], stages: Mapping[str, Stage], folder: Path
) -> FleetSummary:
    """Fly the fleet; leave a folder for each vehicle. Ctrl-C lands all.

    Args:
        wanted: options of the command.
        members: missions and faults.
        stages: set up by `staged`.
        folder: of the fleet's run.
    """
    operator = Operator()
    logs: dict[str, Logbook] = {}
    with ExitStack() as stack:
        stack.enter_context(landing_on_interrupt(operator))
        for number, member in enumerate(members):
            seed = member_seed(wanted.seed, number)
            log = _logbook(member, stages[member.name], folder, seed)
            logs[member.name] = stack.enter_context(log)
        flown = rehearse_fleet(
            {name: ready._replace(plan=logs[name].plan) for name, ready in stages.items()},
            {name: log.observing((), partial(_truth, stages[name])) for name, log in logs.items()},
            separation=wanted.separation,
            keepers={name: log.keep for name, log in logs.items()},
            operator=operator,
            pace=None if wanted.speed is None else RealTime(wanted.speed),
        )
    for number, member in enumerate(members):
        result = flown.flights[member.name]
        if not isinstance(result, str):
            seed = member_seed(wanted.seed, number)
            _finish(member, seed, result, logs[member.name], landing=operator.wants_down)
    return fleet_summary(wanted, members, flown, landing=operator.wants_down)


def fleet_summary(
    wanted: FleetOptions, members: Sequence[Member], flown: FleetFlight, *, landing: bool
) -> FleetSummary:
    """Return what became of a fleet.

    Args:
        wanted: options of the command.
        members: of the fleet.
        flown: result of the flights.
        landing: someone requested a landing.
    """
    return FleetSummary(
        seed=wanted.seed,
        vehicles=tuple(_member(it, flown.flights[it.name], landing=landing) for it in members),
        separation=wanted.separation,
        measured_by="ground truth",
        encounters=tuple(EncounterSummary(**it._asdict()) for it in flown.encounters),
        collisions=flown.collisions,
    )


def _truth(ready: Stage) -> TrueState:
    return ready.vehicle.truth


def _logbook(member: Member, ready: Stage, folder: Path, seed: int) -> Logbook:
    return Logbook(
        folder / member.name,
        ready.plan,
        scenery_of(ready.world, ready.mission),
        inline(),
        member.mission.path,
        origin_of_loaded(member.mission, seed=seed, faults=member.faults),
        Georeference.fixed(ready.mission.geodetic_origin, date),
    )


def _member(member: Member, result: Rehearsal | str, *, landing: bool) -> MemberSummary:
    name, mission = member.name, member.mission.name
    if isinstance(result, str):
        return MemberSummary(vehicle=name, mission=mission, outcome="lost", reason=result)
    return MemberSummary(
        vehicle=name,
        mission=mission,
        outcome=outcome(result),
        reason=reason(result, landing_requested=landing),
    )


def _finish(member: Member, seed: int, result: Rehearsal, log: Logbook, *, landing: bool) -> None:
    log.finished(
        summarise(
            log.track,
            mission=member.mission.name,
            outcome=outcome(result),
            reason=reason(result, landing_requested=landing),
            seed=seed,
            faults=member.faults,
            parameters=member.mission.parameters,
            grade=result.grade.as_dict(),
            conditions=[it[:3] for it in result.conditions],
            requirements=result.requirements,
            record_hash=log.digest,
        )
    )
