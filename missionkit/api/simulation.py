"""One flight in the built-in simulator."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from missionkit.api.event_loop import outside_loop
from missionkit.api.flight_log import Logbook
from missionkit.api.missions import LoadedMission
from missionkit.api.run_origin import origin_of_loaded
from missionkit.chart.model.mission import Mission
from missionkit.engine.clock import RealTime, date
from missionkit.engine.flight_loop import Observer, Operator
from missionkit.errors import UsageError, nearest
from missionkit.outcome import outcome, reason
from missionkit.recorder.geographic_messages import Georeference
from missionkit.recorder.record_sinks import inline
from missionkit.recorder.run_summary import Summary, summarise
from missionkit.recorder.scenery import scenery_of
from missionkit.rehearsal.rehearse import rehearse as fly_simulated
from missionkit.rehearsal.robot_paths import with_paths
from missionkit.rehearsal.stage import stage, world_of
from missionkit.sim.fault_injection import Fault, parse_fault, refuse_foreign
from missionkit.sim.world import World
from missionkit.sim.world_files import AnyWorld


def rehearse(
    mission: LoadedMission,
    *,
    seed: int = 0,
    faults: Sequence[str] = (),
    observers: Sequence[Observer] = (),
    operator: Operator | None = None,
    speed: float | None = None,
    folder: str | Path | None = None,
) -> Summary:
    """Fly a mission in the built-in simulator, like `missionkit run`, and grade it by ground truth.

    Args:
        mission: a mission returned by `load`.
        seed: seed of everything random; the same seed gives the same flight, bit for bit.
        faults: faults to inject, as for `--fault`: `NAME[=VALUE][@WHEN][+DURATION]`.
        observers: called after every tick (20 Hz) with its `Record` and `Observation`; what one
            raises is listed among the problems, and the flight continues.
        operator: sends events to the chart, or requests a landing.
        speed: multiple of real time; as fast as the machine allows if absent.
        folder: where the flight record, `summary.json` and `track.png` are left; it must not hold
            a record yet. Nothing is written without it.

    Returns:
        How the flight ended, why, the states and transitions it went through, the conditions of
        success, the grade by ground truth (m, s, J, rad), problems.

    Raises:
        FileError: the world cannot be used.
        UsageError: a fault is not known or does not fit the mission, or the folder holds a record.

    Example:
        >>> summary = missionkit.rehearse(mission, seed=3, faults=["gnss_lost@20+5"])
        >>> summary.outcome, summary.reason
        ('success', 'flown as planned')
    """
    model = mission.model
    world = world_of(model, mission.path.parent)
    wrong = [fault_of(text, model, world) for text in faults]
    ready = stage(model, mission.catalogue, world, seed, wrong)
    sinks, operator = inline(), operator or Operator()
    scene = scenery_of(world, model)
    with Logbook(
        folder,
        ready.plan,
        scene,
        sinks,
        mission.path,
        origin_of_loaded(mission, seed=seed, faults=faults),
        Georeference.fixed(model.geodetic_origin, date),
    ) as log:
        observing = log.observing(observers, lambda: ready.vehicle.truth)
        result = outside_loop(
            lambda: fly_simulated(
                ready._replace(plan=log.plan),
                observing,
                operator=operator,
                pace=None if speed is None else RealTime(speed),
                reports=sinks.reports.take,
                keeper=log.keep,
            )
        )
    log.scenery = with_paths(scene, ready.vehicle)
    return log.finished(
        summarise(
            log.track,
            mission=mission.name,
            outcome=outcome(result),
            reason=reason(result, landing_requested=operator.wants_down),
            seed=seed,
            faults=faults,
            parameters=model.params,
            grade=result.grade.as_dict(),
            conditions=[it[:3] for it in result.conditions],
            requirements=result.requirements,
            record_hash=log.digest,
        )
    )


def fault_of(text: str, mission: Mission, world: AnyWorld) -> Fault:
    """Read a fault that this mission in this world can have.

    Args:
        text: NAME[=VALUE][@WHEN][+DURATION].
        mission: whose states `text` may name.
        world: whose markers `text` may name.

    Raises:
        UsageError: it cannot.
    """
    fault = parse_fault(text)
    markers = {marker.id for marker in world.all_markers} if isinstance(world, World) else set()
    if fault.name == "marker_hidden" and fault.value not in {None, *markers}:
        hint = ", ".join(map(str, sorted(markers))) or "it has no markers"
        raise UsageError(f"fault {text!r}: no such marker in world {world.world!r}: {hint}")
    states = mission.by_name()
    if fault.state is not None and fault.state not in states:
        hint = nearest(fault.state, states)
        raise UsageError(f"fault {text!r}: unknown state {fault.state!r}; {hint}")
    refuse_foreign((fault,), world.FAULTS, world.VEHICLE)
    return fault
