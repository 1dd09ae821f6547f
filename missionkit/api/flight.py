"""One flight with a vehicle on MAVLink, real or in an autopilot's own simulation."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from missionkit.api.event_loop import outside_loop
from missionkit.api.flight_log import Logbook
from missionkit.api.interrupts import landing_on_interrupt
from missionkit.api.missions import LoadedMission
from missionkit.api.run_origin import Origin, keep_origin, origin_of_loaded, stamp
from missionkit.api.vehicle_checkpoints import VehicleCheckpointWriter
from missionkit.api.vehicle_flight import fly_vehicle, share_of, vehicle_of
from missionkit.api.vehicle_outcome import FlightLog, outcome_of, reason_of, with_remarks
from missionkit.chart.semantics.requirement_watch import results
from missionkit.engine.clock import date
from missionkit.engine.flight_loop import Keeper, Observer, Operator, each_of
from missionkit.engine.mission_success import conditions
from missionkit.engine.prepared_mission import PreparedMission, prepare
from missionkit.engine.resume.checkpoint_policy import now_and_then
from missionkit.messages import Observation, Record
from missionkit.recorder.geographic_messages import Georeference
from missionkit.recorder.record_sinks import Background, Reports, Sinks, background
from missionkit.recorder.run_folder import held
from missionkit.recorder.run_summary import Summary, summarise
from missionkit.recorder.scenery import scenery_of
from missionkit.recorder.value_codec import is_plain
from missionkit.rehearsal.stage import world_over_mavlink
from missionkit.vehicle.adapter import MavsdkVehicle


def fly(
    mission: LoadedMission,
    address: str,
    *,
    observers: Sequence[Observer] = (),
    operator: Operator | None = None,
    folder: str | Path | None = None,
    camera: int | str | None = None,
    share: Sequence[str] = (),
    system: int | None = None,
    speed: float = 1.0,
    anyway: bool = False,
) -> Summary:
    """Fly a mission with a vehicle on MAVLink, like `missionkit run --vehicle`.

    Ctrl-C lands the vehicle; a second one ends the program, and the vehicle is stopped by the
    guardian. Observers run on threads of their own: one that fails or waits costs its records,
    never the flight. A killed program leaves checkpoints in `folder`, from which `missionkit run
    --vehicle ADDRESS --resume FOLDER` resumes; plug-ins that were given as classes must then be
    installed, or in a file that `--plugin` names.

    Args:
        mission: a mission returned by `load`.
        address: of the vehicle, such as `udpin://0.0.0.0:14540` or `serial:///dev/ttyACM0:921600`.
        observers: called after every tick (20 Hz) with its `Record` and `Observation`.
        operator: sends events to the chart, or requests a landing.
        folder: where the flight record, `summary.json` and `track.png` are left; it must not hold
            a record yet. Nothing is written without it.
        camera: device number, file or URL of the camera, or "rendered" for a drawn one; the
            mission's own if absent.
        share: estimates to send to the autopilot: "pose", "target=NAME".
        system: MAVLink system id, if several vehicles share a link.
        speed: vehicle time over wall time; 1 for real vehicles.
        anyway: take off although a failsafe holds or the pre-flight report says BAD.

    Returns:
        How the flight ended by the vehicle's own account, as `rehearse` returns it. There is no
        grade: only a simulator knows the truth.

    Raises:
        FileError: the world, or the video used as camera, cannot be read.
        UsageError: an argument does not fit, or the folder holds a record.
        NotFitError: the pre-flight report says BAD; the vehicle was not armed.
        VehicleError: the vehicle could not be reached, or must not be commanded.

    Example:
        >>> summary = missionkit.fly(mission, "udpin://0.0.0.0:14540", folder="runs/first")
        >>> summary.outcome
        'success'
    """
    model, root = mission.model, mission.path.parent
    world = world_over_mavlink(model, root)
    plan = prepare(model, mission.catalogue)._replace(arm_anyway=anyway)
    vehicle = vehicle_of(
        address,
        model,
        world,
        speed=speed,
        source=camera,
        folder=root,
        share=share_of(share, model),
        system=system,
    )
    sinks, operator, log = background(), operator or Operator(), FlightLog(plan.chart)
    own = [_Unhurried(f"observer {n}", it, sinks.reports) for n, it in enumerate(observers, 1)]
    scene, origin = scenery_of(world, model), origin_of_loaded(mission)
    with landing_on_interrupt(operator), ExitStack() as whole:
        if folder is not None:
            Path(folder).mkdir(parents=True, exist_ok=True)
            whole.enter_context(held(Path(folder)))
        book = Logbook(
            folder,
            plan,
            scene,
            sinks,
            mission.path,
            origin,
            Georeference(lambda: vehicle.observer.origin, date),
            address,
        )
        save = _saving(book, origin, vehicle, sinks)
        with book, ExitStack() as stack:
            for each in own:
                stack.callback(each.close)
            flown = outside_loop(
                lambda: fly_vehicle(
                    book.plan,
                    vehicle,
                    (log, with_remarks((*book.observing(()), *own), vehicle)),
                    operator=operator,
                    speed=speed,
                    time_limit=model.settings.time_limit,
                    keeper=each_of(*_keepers(plan, save), book.keep),
                    reports=sinks.reports,
                    look_first=not anyway,
                )
            )
        landing_requested, wanted = operator.wants_down, model.success
        summary = summarise(
            book.track,
            mission=mission.name,
            outcome=outcome_of(flown, log.passage, wanted),
            reason=reason_of(flown, log.passage, wanted, landing_requested=landing_requested),
            conditions=[it[:3] for it in conditions(wanted, log.passage, None)],
            requirements=results(plan.chart.watch.requirements, flown.memory.chart.monitors),
            parameters=model.params,
            record_hash=book.digest,
        )
        return book.finished(summary, save)


def _saving(
    book: Logbook, origin: Origin, vehicle: MavsdkVehicle, sinks: Sinks
) -> VehicleCheckpointWriter | None:
    """Return what writes checkpoints, and leave what a resumed run is compared with."""
    if book.folder is None or book.recorder is None:
        return None
    keep_origin(book.folder, origin)
    return VehicleCheckpointWriter(
        book.folder, vehicle, book.recorder, stamp(origin), sinks.checkpoints
    )


def _keepers(plan: PreparedMission, save: VehicleCheckpointWriter | None) -> tuple[Keeper, ...]:
    return () if save is None else (now_and_then(plan.chart, is_plain, save),)


class _Unhurried:
    """Calls an observer on a thread of its own, so that the flight never waits for it."""

    def __init__(self, what: str, observer: Observer, reports: Reports) -> None:
        self._observer = observer
        self._sink = Background(what, reports, persistent=True)

    def __call__(self, record: Record, observation: Observation) -> None:
        self._sink.put(lambda: self._observer(record, observation))

    def close(self) -> None:
        """Wait for what is left."""
        self._sink.close()
