"""`missionkit run --vehicle`: fly a MAVLink vehicle, record, sum up by what it says itself."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

from missionkit.chart.catalogue import Catalogue
from missionkit.chart.model.mission import Mission
from missionkit.cli.cockpit import cockpit
from missionkit.cli.fly import fly_vehicle, vehicle_of
from missionkit.cli.guarded import guarded
from missionkit.cli.keys import planned
from missionkit.cli.order import Order
from missionkit.cli.origin import (
    Origin,
    check_same,
    forget_origin,
    keep_origin,
    origin_of,
    stamp,
)
from missionkit.cli.outcome import numbers
from missionkit.cli.resume_vehicle import Before, Saving, before, woken
from missionkit.engine.flight import Plan, prepare
from missionkit.engine.keeping import now_and_then
from missionkit.engine.loop import End, Flown
from missionkit.errors import ExitCode, UsageError
from missionkit.recorder.codec import is_plain
from missionkit.recorder.flight import FlightRecorder
from missionkit.recorder.folder import free_name, keep_mission, run_folder
from missionkit.recorder.plot import draw
from missionkit.recorder.scenery import scenery_of
from missionkit.recorder.summary import Outcome, Summary, summarise, write_summary
from missionkit.recorder.track import Track
from missionkit.rehearsal import world_of
from missionkit.sim.world import World


def run_on_vehicle(
    order: Order, mission: Mission, catalogue: Catalogue, origin: Origin | None
) -> ExitCode:
    """Fly the mission with the vehicle at an address; `origin` is of a run that is gone on with.

    Raises:
        FileError: the world cannot be used.
        UsageError: an option does not fit, the mission was changed, or the address is none.
        VehicleError: the vehicle could not be reached.
    """
    if order.faults:
        raise UsageError("--fault is for the built-in simulator, not for --vehicle")
    for text in order.events:
        planned(text)
    world = world_of(mission, order.mission.parent)
    plan = prepare(mission, catalogue)
    now, past = origin_of(order, mission), None
    if origin is None or order.resume is None:
        folder = run_folder(order.out, mission.name, "vehicle")
    else:
        folder = order.resume
        check_same(origin, now, folder, force=order.force)
        past = before(folder, stamp(now))
        for wrong in past.loaded.wrong:
            print(wrong, file=sys.stderr)  # noqa: T201
    if origin != now:
        keep_mission(folder, order.mission)
        keep_origin(folder, now)
    flight = Ready(mission, world, plan, folder, stamp(now), past)
    return guarded(order, folder, lambda: _flown(order, flight))


class Ready(NamedTuple):
    """What one flight is flown with, and recorded into."""

    mission: Mission
    world: World
    plan: Plan
    folder: Path
    stamp: str  # of what it stands on
    past: Before | None  # what it goes on from


def _flown(order: Order, ready: Ready) -> Summary:
    mission, world, plan, folder, standing, past = ready
    scenery = scenery_of(world)
    speed = order.speed or 1.0
    vehicle = vehicle_of(
        str(order.vehicle), mission, world, seed=order.seed, speed=speed, source=order.source
    )
    recorder = FlightRecorder(
        folder,
        camera=plan.camera,
        scenery=scenery,
        name=free_name(folder, "flight.mcap"),
        past=None if past is None else past.track,
    )
    save = Saving(folder, vehicle, recorder, standing, past)
    with cockpit(order, mission, recorder, give_back=vehicle.resume_control) as seat:
        flown = fly_vehicle(
            plan,
            vehicle,
            seat.observers,
            operator=seat.operator,
            speed=speed,
            time_limit=mission.settings.time_limit,
            keeper=now_and_then(plan.chart, is_plain, save),
            resume=None if past is None else lambda: woken(past, vehicle, speed),
        )
    summary = summarise(
        recorder.track,
        mission=mission.name,
        outcome=_outcome(mission, flown, recorder.track),
        reason=_reason(mission, flown, recorder.track, asked=seat.operator.wants_down),
        parameters=mission.params,
        record_hash=recorder.close(),
    )
    write_summary(folder, summary)
    title = f"{summary.mission}: {summary.outcome}"
    draw(folder / "track.png", recorder.track, scenery, title, numbers(summary))
    save.forget()
    forget_origin(folder)
    return summary


def _outcome(mission: Mission, flown: Flown, track: Track) -> Outcome:
    if flown.end in {End.SILENT, End.OUT_OF_TIME}:
        return "crash"
    return "success" if not _missed(mission, flown, track) else "ended_safely"


def _missed(mission: Mission, flown: Flown, track: Track) -> str:
    """Say what success lacks; how near the goal was, only a simulator's truth can tell."""
    if flown.end is not End.LANDED:
        return str(flown.end)
    if flown.aborted:
        return "landed because it was asked for or time ran out"
    wanted = None if mission.success is None else mission.success.visit
    if wanted is not None and wanted not in {visit.state for visit in track.visits}:
        return f"landed without reaching {wanted}"
    return ""


def _reason(mission: Mission, flown: Flown, track: Track, *, asked: bool) -> str:
    missed = _missed(mission, flown, track)
    if flown.aborted and flown.end is End.LANDED:
        return f"landed because {'the operator asked for it' if asked else 'time ran out'}"
    return missed or "flown as planned, by the vehicle's own account"
