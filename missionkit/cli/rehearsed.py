"""`missionkit run` in the built-in simulator: fly, record, grade by ground truth."""

from __future__ import annotations

import sys
from pathlib import Path

from missionkit.chart.catalogue import Catalogue
from missionkit.chart.model.mission import Mission
from missionkit.cli.cockpit import cockpit
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
from missionkit.cli.outcome import numbers, summed_up
from missionkit.cli.resume import Saving, Since, since
from missionkit.engine.clock import Pace, RealTime
from missionkit.errors import ExitCode, UsageError, nearest
from missionkit.recorder.flight import FlightRecorder
from missionkit.recorder.folder import free_name, keep_mission, run_folder
from missionkit.recorder.plot import draw
from missionkit.recorder.scenery import scenery_of
from missionkit.recorder.summary import Summary, write_summary
from missionkit.rehearsal import Again, Stage, rehearse, stage, world_of
from missionkit.sim.faults import Fault, parse_fault
from missionkit.sim.world import World


def run_in_simulator(
    order: Order, mission: Mission, catalogue: Catalogue, before: Origin | None
) -> ExitCode:
    """Fly the mission in the simulator; `before` is what a run that is gone on with flew.

    Raises:
        FileError: the world cannot be used.
        UsageError: an option does not fit, or the mission was changed.
    """
    origin = origin_of(order, mission)
    ready = _staged(order, mission, catalogue)
    past = None
    if before is None or order.resume is None:
        folder = run_folder(order.out, mission.name, f"seed{order.seed}")
    else:
        folder = order.resume
        check_same(before, origin, folder, force=order.force)
        past = since(folder, order.gap, stamp(origin))
        for wrong in past.loaded.wrong:
            print(wrong, file=sys.stderr)  # noqa: T201
    if before != origin:
        keep_mission(folder, order.mission)
        keep_origin(folder, origin)
    return guarded(order, folder, lambda: _flown(order, ready, folder, stamp(origin), past))


def _staged(order: Order, mission: Mission, catalogue: Catalogue) -> Stage:
    world = world_of(mission, order.mission.parent)
    faults = [fault_of(text, mission, world) for text in order.faults]
    for text in order.events:
        planned(text)
    return stage(mission, catalogue, world, order.seed, faults)


def fault_of(text: str, mission: Mission, world: World) -> Fault:
    """Read a fault that this mission in this world can have.

    Raises:
        UsageError: it cannot.
    """
    fault = parse_fault(text)
    markers = {marker.id for marker in world.markers}
    if fault.name == "marker_hidden" and fault.value not in {None, *markers}:
        hint = ", ".join(map(str, sorted(markers))) or "it has no markers"
        raise UsageError(f"fault {text!r}: no such marker in world {world.world!r}: {hint}")
    states = mission.by_name()
    if fault.state is not None and fault.state not in states:
        hint = nearest(fault.state, states)
        raise UsageError(f"fault {text!r}: unknown state {fault.state!r}; {hint}")
    return fault


def _flown(order: Order, ready: Stage, folder: Path, standing: str, past: Since | None) -> Summary:
    scenery = scenery_of(ready.world)
    recorder = FlightRecorder(
        folder,
        camera=ready.plan.camera,
        scenery=scenery,
        name=free_name(folder, "flight.mcap"),
        past=None if past is None else past.track,
    )
    again = None if past is None else past.again
    with cockpit(order, ready.mission, recorder, lambda: ready.vehicle.truth) as seat:
        save = Saving(folder, ready, recorder, standing, past)
        result = rehearse(
            ready,
            seat.observers,
            operator=seat.operator,
            pace=_pace(order, again),
            save=save,
            again=again,
        )
    asked = seat.operator.wants_down
    summary = summed_up(order, ready.mission, recorder, result, asked=asked)
    write_summary(folder, summary)
    title = f"{summary.mission}: {summary.outcome}"
    draw(folder / "track.png", recorder.track, scenery, title, numbers(summary))
    save.forget()
    forget_origin(folder)
    return summary


def _pace(order: Order, again: Again | None) -> Pace | None:
    if order.speed is None:
        return None
    return RealTime(order.speed, 0.0 if again is None else again.now)
