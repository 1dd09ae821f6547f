"""A real vehicle, or a simulated autopilot, on the command line."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from missionkit.chart.model.mission import Mission
from missionkit.engine.clock import RealTime
from missionkit.engine.flight import Plan
from missionkit.engine.loop import Flown, Keeper, Observer, Operator, fly, keep_nothing
from missionkit.engine.waking import Resumption
from missionkit.errors import ExitCode, UsageError
from missionkit.messages import Frame
from missionkit.sim.world import World
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.address import parse
from missionkit.vehicle.camera import Camera, NoCamera, Painter, Rendered
from missionkit.vehicle.device import Device, opened
from missionkit.vehicle.inspection import inspect
from missionkit.vehicle.pose import Pose
from missionkit.vehicle.sharing import NOTHING, Share

Source = int | str


def vehicle_of(
    address: str,
    mission: Mission,
    world: World | None = None,
    *,
    seed: int = 0,
    speed: float = 1.0,
    source: Source | None = None,
    share: Share = NOTHING,
) -> MavsdkVehicle:
    """Return the vehicle at an address, with the mission's camera.

    Args:
        address: such as udpin://0.0.0.0:14540.
        mission: says which camera it has.
        world: what a rendered camera sees.
        seed: of the rendered camera's noise.
        speed: seconds of the vehicle in one of the wall; 1 for everything that is real.
        source: device number, file or URL of a real camera; None: the mission's own, real or drawn.
        share: what of the estimate the autopilot is told.

    Raises:
        UsageError: the address is none.
    """
    camera = _camera(mission, world, seed, speed, source)
    return MavsdkVehicle(parse(address), camera, speed, share=share)


def fly_vehicle(
    plan: Plan,
    vehicle: MavsdkVehicle,
    observers: Sequence[Observer] = (),
    *,
    operator: Operator | None = None,
    speed: float = 1.0,
    time_limit: float = 1800.0,
    keeper: Keeper = keep_nothing,
    resume: Callable[[], Resumption] | None = None,
) -> Flown:
    """Fly a mission with a vehicle on MAVLink, tied to the wall clock.

    Raises:
        VehicleError: the vehicle could not be reached, or is to be left alone.
    """
    return asyncio.run(
        fly(
            plan,
            vehicle,
            (*observers, vehicle.tell),
            operator=operator,
            pace=FromFirstTick(speed),
            time_limit=time_limit,
            believe_stopwatch=True,
            keeper=keeper,
            resume=resume,
        )
    )


def preflight(address: str, *, as_json: bool = False, patience: float = 10.0) -> ExitCode:
    """Print the pre-flight report of the vehicle at an address.

    Raises:
        UsageError: the address is none.
        VehicleError: nobody answers there.
    """
    vehicle = MavsdkVehicle(parse(address), patience=patience)

    async def look() -> ExitCode:
        await vehicle.connect()
        try:
            report = await inspect(vehicle)
        finally:
            await vehicle.close()
        print(report.json() if as_json else report.text())  # noqa: T201
        return ExitCode.SUCCESS if report.fit else ExitCode.ENDED_SAFELY

    return asyncio.run(look())


class FromFirstTick:
    """Ties mission time to the wall from the first tick on, however long connecting took."""

    def __init__(self, speed: float = 1.0) -> None:
        self._speed = speed
        self._pace: RealTime | None = None

    async def until(self, at: float) -> None:
        """Sleep until the wall clock has caught up with mission time `at` (s)."""
        if self._pace is None:
            self._pace = RealTime(self._speed, at)
        await self._pace.until(at)


def _camera(
    mission: Mission, world: World | None, seed: int, speed: float, source: Source | None
) -> Camera:
    model, camera = mission.camera.model(), mission.camera
    source = camera.source if source is None else source
    if source is not None:
        file = isinstance(source, str) and Path(source).is_file()
        period = model.period / speed if file else 0.0
        return Device(lambda: opened(source), camera.latency, camera.width, camera.height, period)
    if camera.use == "none":
        return NoCamera()
    if world is None:
        raise UsageError("a drawn camera needs a world: name one in the mission, or give a source")
    return Rendered(painter_of(mission, world, seed), camera.rate, speed)


def painter_of(mission: Mission, world: World, seed: int = 0) -> Painter:
    """Return what draws the world as the mission's camera sees it."""
    rng, model = np.random.default_rng(seed), mission.camera.model()
    exposure, nothing = mission.camera.exposure, frozenset[int]()
    if mission.camera.use == "rendered":
        from missionkit.sim.render import Renderer  # noqa: PLC0415 (imports cv2)

        renderer = Renderer(world, model, rng)

        def paint(pose: Pose, at: float) -> Frame:
            turned = pose.velocity, pose.rates
            return Frame(at, renderer.render(pose.body, *turned, exposure, nothing))

        return paint
    from missionkit.sim.obstacles import table  # noqa: PLC0415 (compiles kernels)
    from missionkit.sim.sight import Spotter  # noqa: PLC0415

    spotter = Spotter(world.markers, model, table(world), rng)

    def find(pose: Pose, at: float) -> Frame:
        body = pose.body
        x = np.concatenate((body.translation, pose.velocity, body.rotation, pose.rates))
        return Frame(at, None, spotter.find(x, exposure, nothing))

    return find
