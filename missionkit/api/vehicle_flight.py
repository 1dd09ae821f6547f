"""A real vehicle, or a simulated autopilot, on the command line."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from pathlib import Path

from missionkit.api.vehicle_camera import camera_of
from missionkit.behaviors.land_on import LandOn
from missionkit.chart.model.mission import Mission
from missionkit.engine.clock import RealTime
from missionkit.engine.flight_end import FlownFlight
from missionkit.engine.flight_loop import Keeper, Observer, Operator, fly, keep_nothing
from missionkit.engine.prepared_mission import PreparedMission
from missionkit.engine.resume.resumption import Resumption
from missionkit.errors import UsageError, nearest
from missionkit.estimation.optical_flow.flow_parameters import FlowKalman
from missionkit.estimation.ud_vision.parameters import UdVisionEkf
from missionkit.recorder.record_sinks import CHECKPOINTS, Reports, contained
from missionkit.sim.world import World
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.command.estimate_sharing import SHARE_NOTHING, Share
from missionkit.vehicle.guardian.policy import USUAL, Patience
from missionkit.vehicle.link.link_address import parse
from missionkit.vehicle.link.traffic_link import TrafficLink
from missionkit.vehicle.preflight.inspection import become_fit
from missionkit.vehicle.telemetry.mission_origin import MissionOrigin
from missionkit.vehicle.telemetry.required_inputs import (
    EXTERNAL_INPUT,
    FIX_INPUT,
    FLOW_INPUT,
    IMAGE_INPUT,
    SCAN_INPUT,
)

NOTED = "an observer"
LAG_ALLOWED = 0.1  # s, of a simulated autopilot's clock: messages come by the tick
LONGEST_WAIT = 0.05  # s, of the vehicle
READY_INTERVAL = 0.1  # s between two times that a vehicle says it is ready


def vehicle_of(
    address: str,
    mission: Mission,
    world: World | None = None,
    *,
    seed: int = 0,
    speed: float = 1.0,
    source: int | str | None = None,
    folder: Path = Path(),
    share: Share = SHARE_NOTHING,
    system: int | None = None,
    guard: Patience | None = USUAL,
    traffic: TrafficLink | None = None,
) -> MavsdkVehicle:
    """Return the vehicle at an address, with the mission's camera.

    Args:
        address: such as udpin://0.0.0.0:14540.
        mission: says which camera it has.
        world: what a drawn camera sees.
        seed: of the drawn camera's noise.
        speed: seconds of the vehicle in one of the wall; 1 for everything that is real.
        source: device number, file or URL of a real camera, or "rendered": a drawn one;
            None: the mission's own.
        folder: of the mission, which a file that it names is looked for in.
        share: which parts of the estimate are sent to the autopilot.
        system: its MAVLink system id, where several share the link.
        guard: how long its guardian bears silence (s, of the wall: what makes this computer slow
            lasts as long however fast a simulated vehicle's time goes); None: no guardian.
        traffic: to the other vehicles of its fleet, if it flies in one.

    Raises:
        FileError: the mission names a file for a camera, and there is none.
        UsageError: the address is none, or the source does not exist.
    """
    camera = camera_of(mission, folder, world, seed=seed, speed=speed, source=source)
    patience = None if guard is None else Patience(speed * guard.brake, speed * guard.hold)
    return MavsdkVehicle(
        parse(address),
        camera,
        speed,
        share=share,
        system=system,
        guard=patience,
        relies_on=relied_on(mission),
        wanted=origin_wanted(mission),
        traffic=traffic,
        gimbal=mission.camera.gimbal is not None,
        lands_precisely=lands_precisely(mission),
    )


def origin_wanted(mission: Mission) -> MissionOrigin | None:
    """Return the origin that a vehicle must measure from; None: its home."""
    if mission.origin is None:
        return None
    by_fixes = FIX_INPUT in relied_on(mission)
    return MissionOrigin(mission.origin.geodetic, mission.has_amsl, by_fixes)


def lands_precisely(mission: Mission) -> bool:
    """Say whether a mission orders the autopilot's own precision landing."""
    behaviors = (it.state.behavior for it in mission.walk())
    plugins = (None if it is None else it.plugin for it in behaviors)
    return any(isinstance(it, LandOn) and it.by == "autopilot" for it in plugins)


def relied_on(mission: Mission) -> frozenset[str]:
    """Return what a mission relies on: where it is, and scans of obstacles."""
    navigation = mission.navigation.plugin
    by = FIX_INPUT
    if isinstance(navigation, FlowKalman) or getattr(navigation, "flow", False):
        by = FLOW_INPUT
    elif isinstance(navigation, UdVisionEkf):
        by = IMAGE_INPUT
    elif getattr(navigation, "external_pose", False):
        by = EXTERNAL_INPUT
    return frozenset({by} | ({SCAN_INPUT} if mission.avoid is not None else set()))


def share_of(texts: Sequence[str], mission: Mission) -> Share:
    """Return which estimates to send to the autopilot: `pose`, `target=NAME`, or both.

    Raises:
        UsageError: it is neither, or the mission has no such target.
    """
    share = SHARE_NOTHING
    for text in texts:
        what, _, name = text.partition("=")
        if text == "pose":
            share = share._replace(pose=True)
        elif what != "target" or share.target not in {None, name}:
            raise UsageError(f"--share {text}: must be pose, or target=NAME of one target")
        elif name not in mission.targets:
            raise UsageError(f"--share {text}: no such target; {nearest(name, mission.targets)}")
        else:
            share = share._replace(target=name)
    return share


def fly_vehicle(
    plan: PreparedMission,
    vehicle: MavsdkVehicle,
    observers: Sequence[Observer] = (),
    *,
    operator: Operator | None = None,
    speed: float = 1.0,
    time_limit: float = 1800.0,
    keeper: Keeper = keep_nothing,
    reports: Reports | None = None,
    resume: Callable[[], Resumption] | None = None,
    look_first: bool = False,
    simulated: bool = False,
) -> FlownFlight:
    """Fly a mission with a vehicle on MAVLink, tied to the wall clock.

    Nothing that observers or the keeper raise ends the flight; `reports` takes it.

    Args:
        plan: the mission, ready to fly.
        vehicle: what carries it out.
        observers: called after every tick.
        operator: may request a landing.
        speed: seconds of the vehicle in one of the wall.
        time_limit: mission time (s) after which the flight is aborted.
        keeper: called after every tick with everything needed to resume from it.
        reports: takes what fails beside the flight.
        resume: continues a flight in progress.
        look_first: begin only once the pre-flight report has nothing against flying.
        simulated: a simulated autopilot, as one always is at another `speed` than 1: mission time
            waits for its clock.

    Raises:
        NotFitError: the pre-flight report speaks against flying.
        VehicleError: the vehicle could not be reached, or must not be commanded.
    """
    reports, operator = reports or Reports(), operator or Operator()
    tell = contained("sharing the estimate with the autopilot", vehicle.tell, reports)

    async def flight() -> FlownFlight:
        if look_first:
            await _fit(vehicle, operator, speed)
            await _together(vehicle, operator)
        return await fly(
            plan,
            vehicle,
            (*(contained(NOTED, it, reports) for it in observers), tell),
            operator=operator,
            pace=FromFirstTick(speed, vehicle if simulated or speed != 1.0 else None),
            time_limit=time_limit,
            believe_stopwatch=True,
            keeper=contained(CHECKPOINTS, keeper, reports),
            reports=reports.take,
            resume=resume,
        )

    return asyncio.run(flight())


async def _fit(vehicle: MavsdkVehicle, operator: Operator, speed: float) -> None:
    """Reach the vehicle, which stays connected, and wait until it is fit to fly."""
    await vehicle.connect()
    try:
        await become_fit(vehicle, lambda: operator.wants_down, speed)
    except BaseException:
        await vehicle.close()
        raise


async def _together(vehicle: MavsdkVehicle, operator: Operator) -> None:
    """Wait until the other vehicles of the fleet are ready too, or have failed."""
    traffic = vehicle.traffic
    while traffic is not None and not (traffic.started or operator.wants_down):
        traffic.ready()
        vehicle.maintain()
        await asyncio.sleep(READY_INTERVAL)


class FromFirstTick:
    """Ties mission time to the wall from the first tick on, however long connecting took.

    Args:
        speed: seconds of the vehicle in one of the wall.
        simulated: a simulated autopilot, whose clock mission time waits for where it lags: by a
            tick at most for each, so that time never stands still.
    """

    def __init__(self, speed: float = 1.0, simulated: MavsdkVehicle | None = None) -> None:
        self._speed = speed
        self._simulated = simulated
        self._pace: RealTime | None = None

    async def until(self, at: float) -> None:
        """Sleep until the wall clock has caught up with mission time `at` (s)."""
        if self._pace is None:
            self._pace = RealTime(self._speed, at)
        await self._pace.until(at)
        lag = 0.0 if self._simulated is None else self._simulated.lag(at) - LAG_ALLOWED
        if self._simulated is not None and lag > 0.0:
            wait = min(lag, LONGEST_WAIT) / self._speed
            self._simulated.put_off(wait)
            await self._pace.put_off(wait)
