"""`missionkit run`: fly, watch, record, grade, sum up."""

from __future__ import annotations

import signal
import sys
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext
from pathlib import Path

from missionkit.chart.catalogue import Catalogue
from missionkit.chart.checks import findings
from missionkit.chart.load import load
from missionkit.chart.model.contracts import unmet
from missionkit.chart.model.mission import Mission
from missionkit.cli.catalogue import assemble, overrides
from missionkit.cli.keys import Keys, Planned, offered, planned
from missionkit.cli.live import LineView, PageView, live_view
from missionkit.cli.order import Order
from missionkit.cli.origin import (
    check_same,
    forget_origin,
    found_origin,
    keep_origin,
    origin_of,
    recalled,
    stamp,
)
from missionkit.cli.outcome import exit_code, numbers, report, summed_up
from missionkit.cli.resume import Saving, Since, since
from missionkit.engine.clock import Pace, RealTime, stopwatch
from missionkit.engine.loop import Operator
from missionkit.errors import ExitCode, FileError, Level, MissionkitError, UsageError, nearest
from missionkit.messages import Observation, Record
from missionkit.recorder.flight import FlightRecorder
from missionkit.recorder.folder import free_name, keep_mission, run_folder
from missionkit.recorder.plot import draw
from missionkit.recorder.scenery import scenery_of
from missionkit.recorder.summary import Summary, write_summary
from missionkit.rehearsal import Again, Stage, rehearse, stage, world_of
from missionkit.sim.faults import Fault, parse_fault
from missionkit.sim.world import World


def run(order: Order) -> ExitCode:
    """Fly the mission; leave a folder with its record, summary and picture.

    Raises:
        FileError: mission, world or plug-in file cannot be used.
        UsageError: an option does not fit, or there is nothing to resume.
        VehicleError: the vehicle could not be reached, or is to be left alone.
    """
    before = None if order.resume is None else found_origin(order.resume)
    order = order if before is None else recalled(order, before)
    catalogue = assemble(order.plugins)
    mission = load(order.mission, catalogue, overrides(order.settings))
    _refuse(mission, catalogue)
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
    return _ended(order, ready, folder, stamp(origin), past)


def _refuse(mission: Mission, catalogue: Catalogue) -> None:
    """Refuse a mission with errors; `missionkit validate` tells its warnings too.

    Raises:
        FileError: the contracts of its states are not met, or its chart cannot be right.
    """
    problems = unmet(mission, catalogue) or findings(mission, catalogue)
    if errors := [problem for problem in problems if problem.level is Level.ERROR]:
        raise FileError(errors)


def _ended(order: Order, ready: Stage, folder: Path, standing: str, past: Since | None) -> ExitCode:
    try:
        summary = _flown(order, ready, folder, standing, past)
    except MissionkitError:
        raise
    except KeyboardInterrupt:
        print(f"stopped before it had landed; see {folder}", file=sys.stderr)  # noqa: T201
        return ExitCode.VEHICLE_LOST
    except Exception:  # noqa: BLE001 - the flight record stays, the person gets a sentence
        (folder / "crash.txt").write_text(traceback.format_exc(), encoding="utf-8")
        print(f"missionkit crashed; see {folder / 'crash.txt'}", file=sys.stderr)  # noqa: T201
        return ExitCode.CRASH
    report(order, summary, folder)
    return exit_code(summary)


def _staged(order: Order, mission: Mission, catalogue: Catalogue) -> Stage:
    world = world_of(mission, order.mission.parent)
    faults = [_fault(text, mission, world) for text in order.faults]
    for text in order.events:
        planned(text)
    return stage(mission, catalogue, world, order.seed, faults)


def _fault(text: str, mission: Mission, world: World) -> Fault:
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
    scenery, operator, view = scenery_of(ready.world), Operator(), None
    events: dict[str, str] = {}
    if not (order.headless or order.as_json):
        events = offered(ready.mission)
        view = live_view(sys.stdout, stopwatch, _title(ready.mission.name, events))
    recorder = FlightRecorder(
        folder,
        camera=ready.plan.camera,
        scenery=scenery,
        name=free_name(folder, "flight.mcap"),
        past=None if past is None else past.track,
    )
    again = None if past is None else past.again
    keys = Keys(sys.stdin, operator, events)
    plan = Planned(order.events, operator)
    with recorder, view or nullcontext(), keys, _landing_on_interrupt(operator):
        pace = _pace(order, again)
        watch = _Watch(ready, recorder, view)
        save = Saving(folder, ready, recorder, standing, past)
        observers = (watch, keys, plan)
        result = rehearse(ready, observers, operator=operator, pace=pace, save=save, again=again)
    asked = operator.wants_down
    summary = summed_up(order, ready.mission, recorder, result, asked=asked)
    write_summary(folder, summary)
    title = f"{summary.mission}: {summary.outcome}"
    draw(folder / "track.png", recorder.track, scenery, title, numbers(summary))
    save.forget()
    forget_origin(folder)
    return summary


def _title(mission: str, events: Mapping[str, str]) -> str:
    """Return what stands above the live page: the mission, and which key sends which event."""
    keys = ", ".join(f"{key} {event}" for key, event in events.items())
    return f"{mission} — keys: {keys}" if keys else mission


def _pace(order: Order, again: Again | None) -> Pace | None:
    if order.speed is None:
        return None
    return RealTime(order.speed, 0.0 if again is None else again.now)


class _Watch:
    """Passes every tick on to the recorder and the view."""

    def __init__(
        self, ready: Stage, recorder: FlightRecorder, view: LineView | PageView | None
    ) -> None:
        self._vehicle = ready.vehicle
        self._recorder = recorder
        self._view = view

    def __call__(self, record: Record, observation: Observation) -> None:
        self._recorder.write(record, observation.frame, self._vehicle.truth)
        if self._view is not None:
            self._view.update(record)


@contextmanager
def _landing_on_interrupt(operator: Operator) -> Iterator[None]:
    """Let the first Ctrl-C land the vehicle and the second one stop the program."""

    def land(*_: object) -> None:
        operator.land()
        signal.signal(signal.SIGINT, signal.default_int_handler)

    before = signal.signal(signal.SIGINT, land)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
