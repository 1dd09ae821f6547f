"""`missionkit run`: fly, watch, record, grade, sum up."""

from __future__ import annotations

import json
import signal
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any, NamedTuple

from missionkit.chart.catalogue import Catalogue
from missionkit.chart.contracts import unmet
from missionkit.chart.load import load
from missionkit.chart.model import Mission, Success
from missionkit.cli.catalogue import assemble, overrides
from missionkit.cli.live import LineView, PageView, live_view
from missionkit.engine.clock import RealTime, stopwatch
from missionkit.engine.loop import End, Operator
from missionkit.errors import ExitCode, FileError, MissionkitError, UsageError, nearest
from missionkit.messages import Observation, Record
from missionkit.recorder.flight import FlightRecorder
from missionkit.recorder.folder import keep_mission, run_folder
from missionkit.recorder.plot import draw
from missionkit.recorder.scenery import scenery_of
from missionkit.recorder.summary import Summary, summarise, write_summary
from missionkit.recorder.track import Track
from missionkit.rehearsal import Rehearsal, Stage, rehearse, stage, world_of
from missionkit.sim.faults import Fault, parse_fault
from missionkit.sim.world import World


class Order(NamedTuple):
    """What the command line asked for."""

    mission: Path
    settings: tuple[str, ...]
    plugins: tuple[Path, ...]
    seed: int
    faults: tuple[str, ...]
    speed: float | None
    out: Path
    headless: bool
    as_json: bool


def run(order: Order) -> ExitCode:
    """Fly the mission; leave a folder with its record, summary and picture.

    Raises:
        FileError: mission, world or plug-in file cannot be used.
        UsageError: an option does not fit.
        VehicleError: the vehicle could not be reached.
    """
    catalogue = assemble(order.plugins)
    mission = load(order.mission, catalogue, overrides(order.settings))
    if problems := unmet(mission, catalogue):
        raise FileError(problems)
    ready = _staged(order, mission, catalogue)
    folder = run_folder(order.out, mission.name, f"seed{order.seed}")
    keep_mission(folder, order.mission)
    try:
        summary = _flown(order, ready, folder)
    except MissionkitError:
        raise
    except KeyboardInterrupt:
        print(f"stopped before it had landed; see {folder}", file=sys.stderr)  # noqa: T201
        return ExitCode.VEHICLE_LOST
    except Exception:  # noqa: BLE001 - the flight record stays, the person gets a sentence
        (folder / "crash.txt").write_text(traceback.format_exc(), encoding="utf-8")
        print(f"missionkit crashed; see {folder / 'crash.txt'}", file=sys.stderr)  # noqa: T201
        return ExitCode.CRASH
    _report(order, summary, folder)
    return _exit_code(summary)


def _staged(order: Order, mission: Mission, catalogue: Catalogue) -> Stage:
    world = world_of(mission, order.mission.parent)
    faults = [_fault(text, mission, world) for text in order.faults]
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


def _flown(order: Order, ready: Stage, folder: Path) -> Summary:
    scenery, operator, view = scenery_of(ready.world), Operator(), None
    if not (order.headless or order.as_json):
        view = live_view(sys.stdout, stopwatch, ready.mission.name)
    recorder = FlightRecorder(folder, camera=ready.plan.camera, scenery=scenery)
    with recorder, view or nullcontext(), _landing_on_interrupt(operator):
        pace = None if order.speed is None else RealTime(order.speed)
        watch = _Watch(ready, recorder, view)
        result = rehearse(ready, (watch,), operator=operator, pace=pace)
    asked = operator.wants_down
    summary = _summed_up(order, ready.mission, recorder, result, asked=asked)
    write_summary(folder, summary)
    title = f"{summary.mission}: {summary.outcome}"
    draw(folder / "track.png", recorder.track, scenery, title, _numbers(summary))
    return summary


def _summed_up(
    order: Order, mission: Mission, recorder: FlightRecorder, result: Rehearsal, *, asked: bool
) -> Summary:
    return summarise(
        recorder.track,
        mission=mission.name,
        outcome="success" if result.succeeded else _failure(result),
        reason=_reason(mission, result, recorder.track, asked=asked),
        seed=order.seed,
        faults=order.faults,
        parameters=mission.params,  # with --set
        grade=result.grade.as_dict(),
        record_hash=recorder.close(),
    )


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


def _failure(result: Rehearsal) -> Any:
    never_left = result.flown.end is End.NEVER_LEFT and not result.grade.crashed
    return "ended_safely" if result.grade.landed or never_left else "crash"


def _reason(mission: Mission, result: Rehearsal, track: Track, *, asked: bool) -> str:
    grade = result.grade
    if result.succeeded:
        return "flown as planned"
    if grade.crashed:
        return "hit an obstacle or the ground"
    if result.flown.end is not End.LANDED:
        return str(result.flown.end)
    if result.flown.aborted:
        return f"landed because {'the operator asked for it' if asked else 'time ran out'}"
    if mission.success is not None and grade.visit is None:
        return _unreached(mission.success, track)
    return "landed, but the goal was missed by more than allowed"


def _unreached(success: Success, track: Track) -> str:
    if success.visit not in {visit.state for visit in track.visits}:
        return f"landed without reaching {success.visit}"
    return f"landed, but the world has no marker of {success.target} to measure the goal by"


def _numbers(summary: Summary) -> str:
    grade, timing = summary.grade, summary.timing
    parts = [summary.reason, f"{summary.duration:.0f} s", f"{grade['distance']:.0f} m flown"]
    if grade["visit"] is not None:
        error = 100.0 * grade["visit"]["position_error"]
        parts.append(f"{error:.1f} cm from the goal on arrival")
    if grade["clearance"] is not None:
        parts.append(f"clearance {grade['clearance']:.2f} m")
    if timing is not None:
        parts.append(f"cycle p99 {timing.total.p99:.1f} ms")
    return ", ".join(parts)


def _report(order: Order, summary: Summary, folder: Path) -> None:
    if order.as_json:
        print(json.dumps({**summary.model_dump(), "folder": str(folder)}, indent=2))  # noqa: T201
        return
    print(f"{summary.outcome}: {_numbers(summary)}\n{folder}")  # noqa: T201


def _exit_code(summary: Summary) -> ExitCode:
    return {
        "success": ExitCode.SUCCESS,
        "ended_safely": ExitCode.ENDED_SAFELY,
        "crash": ExitCode.VEHICLE_LOST,
    }[summary.outcome]
