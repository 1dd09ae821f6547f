"""`missionkit run --vehicle`: fly a MAVLink vehicle, record, sum up by what it says itself."""

from __future__ import annotations

import os
import sys
import threading
from functools import partial
from typing import NamedTuple

from missionkit.api.run_origin import Origins
from missionkit.api.vehicle_checkpoints import (
    Before,
    VehicleCheckpointWriter,
    before,
    woken,
)
from missionkit.api.vehicle_flight import fly_vehicle, share_of, vehicle_of
from missionkit.api.vehicle_outcome import FlightLog, outcome_of, reason_of, with_remarks
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.semantics.requirement_watch import results
from missionkit.cli.operator_terminal import cockpit
from missionkit.cli.run_errors import guarded
from missionkit.cli.run_options import RunOptions
from missionkit.cli.run_output import Folder, folder_of
from missionkit.cli.run_page import ended, page_of
from missionkit.engine.clock import date
from missionkit.engine.flight_end import AT_REST
from missionkit.engine.flight_loop import Operator, each_of
from missionkit.engine.mission_success import conditions
from missionkit.engine.prepared_mission import PreparedMission, prepare
from missionkit.engine.resume.checkpoint_policy import now_and_then
from missionkit.errors import ExitCode, UsageError
from missionkit.page.facts.mission_facts import FlownMission
from missionkit.page.live.flight_page import FlightPage
from missionkit.recorder.geographic_messages import Georeference
from missionkit.recorder.record_sinks import background
from missionkit.recorder.run_summary import Summary, summarise
from missionkit.recorder.scenery import Scenery, scenery_of
from missionkit.recorder.value_codec import is_plain
from missionkit.rehearsal.stage import world_over_mavlink
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.link.traffic_link import TrafficLink


def run_on_vehicle(
    order: RunOptions, mission: Mission, catalogue: Catalogue, origins: Origins
) -> ExitCode:
    """Fly the mission with the vehicle at an address; `origins` say what it stands on.

    Args:
        order: the options of the command.
        mission: loaded, with `--set` applied.
        catalogue: with which the mission was loaded.
        origins: files and options that a resumed run is compared with.

    Raises:
        FileError: the world, or the video used as camera, cannot be read.
        UsageError: an option does not fit, there is no checkpoint, or the address is none.
        NotFitError: the pre-flight report speaks against flying.
        VehicleError: the vehicle could not be reached.
    """
    if order.faults:
        raise UsageError("--fault is for the built-in simulator, not for --vehicle")
    world = world_over_mavlink(mission, order.mission.parent)
    plan = prepare(mission, catalogue)._replace(arm_anyway=order.anyway)
    traffic = None if order.place is None else TrafficLink(order.place, order.speed or 1.0)
    vehicle = vehicle_of(
        str(order.vehicle),
        mission,
        world,
        seed=order.seed,
        speed=order.speed or 1.0,
        source=order.source,
        folder=order.mission.parent,
        share=share_of(order.share, mission),
        system=order.system,
        traffic=traffic,
    )
    with folder_of(order, mission, origins, "vehicle", before) as (folder, past):
        scenery = scenery_of(world, mission)
        shown = FlownMission(mission, catalogue, plan, scenery)
        with page_of(order, shown, folder.path) as page:
            flight = FlightResources(mission, scenery, plan, vehicle, folder, past, page)
            return guarded(order, folder.path, partial(_flown_in_fleet, order, flight))


def _flown_in_fleet(order: RunOptions, ready: FlightResources, operator: Operator) -> Summary:
    """Fly; as one of a fleet, land when whoever started the fleet has gone."""
    if ready.vehicle.traffic is None:
        return _flown(order, ready, operator)
    watch = threading.Thread(target=_landing_with, args=(operator,), name="fleet", daemon=True)
    watch.start()
    return _flown(order, ready, operator)


def _landing_with(operator: Operator) -> None:
    """Land once standard input closes: whoever held it has ended, however that happened."""
    while os.read(sys.stdin.fileno(), 1024):
        pass
    operator.land()


class FlightResources(NamedTuple):
    """Resources of one flight: what flies it, and the folder it is recorded into."""

    mission: Mission
    scenery: Scenery
    plan: PreparedMission
    vehicle: MavsdkVehicle
    folder: Folder
    past: Before | None  # what it resumes from
    page: FlightPage | None


def _flown(order: RunOptions, ready: FlightResources, operator: Operator) -> Summary:
    mission, scenery, plan, vehicle, folder, past, page = ready
    speed = order.speed or 1.0
    sinks = background()
    recorder = folder.recorder(
        plan, scenery, past, sinks.record, Georeference(lambda: vehicle.observer.origin, date)
    )
    save = VehicleCheckpointWriter(
        folder.path, vehicle, recorder, folder.stamp, sinks.checkpoints, past
    )
    kept = folder.journal(plan, past, sinks.journal, str(order.vehicle))
    log = FlightLog(plan.chart, None if past is None else past.track)
    back = vehicle.resume_control
    with cockpit(
        order, operator, mission, recorder, kept, sinks, give_back=back, page=page
    ) as observers:
        flown = fly_vehicle(
            kept.plan,
            vehicle,
            (log, with_remarks(observers, vehicle)),
            operator=operator,
            speed=speed,
            time_limit=mission.settings.time_limit,
            keeper=each_of(now_and_then(plan.chart, is_plain, save), kept.keep),
            reports=sinks.reports,
            resume=None if past is None else lambda: woken(past, vehicle, speed),
            look_first=past is None and not order.anyway,
            simulated=order.sitl is not None,
        )
    if vehicle.traffic is not None and flown.end in AT_REST:
        vehicle.traffic.end()
    landing_requested = operator.wants_down
    summary = summarise(
        recorder.track,
        mission=mission.name,
        outcome=outcome_of(flown, log.passage, mission.success),
        reason=reason_of(flown, log.passage, mission.success, landing_requested=landing_requested),
        conditions=[it[:3] for it in conditions(mission.success, log.passage, None)],
        requirements=results(plan.chart.watch.requirements, flown.memory.chart.monitors),
        parameters=mission.params,
        record_hash=recorder.close(),
    )
    ended(page, summary)
    folder.finish(summary, recorder.track, scenery, sinks.reports, save.forget)
    return summary
