"""What one rehearsal is set up from: mission, plan, world, simulated vehicle."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from pydantic import ValidationError

from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.engine.prepared_mission import PreparedMission, prepare
from missionkit.errors import FileError, Problem, UsageError
from missionkit.sim.fault_injection import Fault
from missionkit.sim.simulators import Simulated, simulated
from missionkit.sim.world import World
from missionkit.sim.world_files import AnyWorld, load_world
from missionkit.states import VEHICLES


class Stage(NamedTuple):
    """Everything set up for one flight."""

    mission: Mission
    plan: PreparedMission
    world: AnyWorld
    vehicle: Simulated


def world_of(mission: Mission, folder: Path) -> AnyWorld:
    """Return the world a mission names, or an empty one.

    Raises:
        FileError: the world file cannot be used, or is that of another kind of vehicle.
        UsageError: there is none, and the kind of vehicle needs one.
    """
    kind = mission.vehicle.use
    if mission.world is None:
        if kind != "sim":
            raise UsageError(f"a mission of a {kind} needs a world: add `world: worlds/NAME.yaml`")
        return _started(World(world="empty"), mission)
    return _started(load_world(folder / mission.world, kind, mission.place("world")), mission)


def _started(world: AnyWorld, mission: Mission) -> AnyWorld:
    """Return the world with the vehicle where the mission says that it stands."""
    start = mission.vehicle.start
    if start is None or not isinstance(world, World):
        return world
    try:
        return world.with_start(start)
    except ValidationError as error:
        why = str(error.errors()[0]["ctx"]["error"])
        raise FileError([Problem(mission.vehicle.place("start"), why)]) from error


def world_over_mavlink(mission: Mission, folder: Path) -> World:
    """Return the world of a mission that is flown over MAVLink, for the camera that is drawn.

    Raises:
        FileError: the world file cannot be used.
        UsageError: no autopilot flies this kind of vehicle.
    """
    kind = VEHICLES[mission.vehicle.use]
    if not kind.over_mavlink:
        raise UsageError(f"a {kind.name} flies in the simulator only: leave its address out")
    world = world_of(mission, folder)
    assert isinstance(world, World)  # noqa: S101 - of what an autopilot flies
    return world


def stage(
    mission: Mission,
    catalogue: Catalogue,
    world: AnyWorld,
    seed: int,
    faults: Sequence[Fault] = (),
) -> Stage:
    """Set up one flight; everything random comes from `seed`.

    Args:
        mission: to fly.
        catalogue: of plug-ins.
        world: to fly in.
        seed: of everything random.
        faults: to inject.

    Raises:
        UsageError: the vehicle would start off the mission's map or in one of its walls.
    """
    known = mission.known
    wrong = "" if known is None or not isinstance(world, World) else known.unfit_start(world.start)
    if wrong and isinstance(world, World):
        north, east = world.start
        raise UsageError(f"world {world.world!r}: it starts at ({north:g}, {east:g}), {wrong}")
    vehicle = simulated(world, mission.camera, seed, faults)
    vehicle.began = mission.settings.utc
    return Stage(mission, prepare(mission, catalogue), world, vehicle)
