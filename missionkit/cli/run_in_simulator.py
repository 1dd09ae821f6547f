"""`missionkit run` in the built-in simulator: fly, record, grade by ground truth."""

from __future__ import annotations

from functools import partial

from missionkit.api.run_origin import Origins
from missionkit.api.simulation import fault_of
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.cli.operator_terminal import cockpit
from missionkit.cli.resume_rehearsal import RehearsalCheckpointWriter, Since, since
from missionkit.cli.run_errors import guarded
from missionkit.cli.run_options import RunOptions
from missionkit.cli.run_output import Folder, folder_of
from missionkit.cli.run_page import ended, page_of
from missionkit.cli.run_result import summed_up
from missionkit.engine.clock import Pace, RealTime, date
from missionkit.engine.flight_loop import Operator
from missionkit.errors import ExitCode
from missionkit.page.facts.mission_facts import FlownMission
from missionkit.page.live.flight_page import FlightPage
from missionkit.recorder.geographic_messages import Georeference
from missionkit.recorder.record_sinks import inline
from missionkit.recorder.run_summary import Summary
from missionkit.recorder.scenery import Scenery, scenery_of
from missionkit.rehearsal.rehearse import Again, rehearse
from missionkit.rehearsal.robot_paths import with_paths
from missionkit.rehearsal.stage import Stage, stage, world_of


def run_in_simulator(
    order: RunOptions, mission: Mission, catalogue: Catalogue, origins: Origins
) -> ExitCode:
    """Fly the mission in the simulator; `origins` say what it stands on.

    Args:
        order: the options of the command.
        mission: loaded, with `--set` applied.
        catalogue: with which the mission was loaded.
        origins: files and options that a resumed run is compared with.

    Raises:
        FileError: the world cannot be used.
        UsageError: an option does not fit, or there is no checkpoint to resume from.
    """
    ready = _staged(order, mission, catalogue)
    with folder_of(
        order,
        mission,
        origins,
        f"seed{order.seed}",
        lambda path, stamp: since(path, order.gap, stamp),
    ) as (folder, past):
        scenery = scenery_of(ready.world, mission)
        shown = FlownMission(mission, catalogue, ready.plan, scenery)
        with page_of(order, shown, folder.path) as page:
            flown = partial(_flown, order, ready, folder, past, page, scenery)
            return guarded(order, folder.path, flown)


def _staged(order: RunOptions, mission: Mission, catalogue: Catalogue) -> Stage:
    world = world_of(mission, order.mission.parent)
    faults = [fault_of(text, mission, world) for text in order.faults]
    ready = stage(mission, catalogue, world, order.seed, faults)
    return ready._replace(plan=ready.plan._replace(arm_anyway=order.anyway))


def _flown(
    order: RunOptions,
    ready: Stage,
    folder: Folder,
    past: Since | None,
    page: FlightPage | None,
    scenery: Scenery,
    operator: Operator,
) -> Summary:
    sinks = inline()
    recorder = folder.recorder(
        ready.plan,
        scenery,
        past,
        sinks.record,
        Georeference.fixed(ready.mission.geodetic_origin, date),
    )
    again = None if past is None else past.again
    kept = folder.journal(ready.plan, past, sinks.journal)
    ready = ready._replace(plan=kept.plan)
    save = RehearsalCheckpointWriter(
        folder.path, ready, recorder, folder.stamp, sinks.checkpoints, past
    )
    with cockpit(
        order,
        operator,
        ready.mission,
        recorder,
        kept,
        sinks,
        lambda: ready.vehicle.truth,
        page=page,
    ) as observers:
        result = rehearse(
            ready,
            observers,
            operator=operator,
            pace=_pace(order, again),
            save=save,
            reports=sinks.reports.take,
            again=again,
            keeper=kept.keep,
        )
    landing_requested = operator.wants_down
    summary = summed_up(order, ready.mission, recorder, result, landing_requested=landing_requested)
    ended(page, summary)
    scenery = with_paths(scenery, ready.vehicle)
    folder.finish(summary, recorder.track, scenery, sinks.reports, save.forget)
    return summary


def _pace(order: RunOptions, again: Again | None) -> Pace | None:
    if order.speed is None:
        return None
    return RealTime(order.speed, 0.0 if again is None else again.now)
