"""`missionkit run`: load, refuse what cannot be right, and fly."""

from __future__ import annotations

from missionkit.api.missions import assemble, refuse
from missionkit.api.run_origin import Origin, Origins, check_same, found_origin, origin_of
from missionkit.chart.load import load
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.cli.overrides import overrides
from missionkit.cli.recalled_options import check_plugins, recalled
from missionkit.cli.run_options import RunOptions
from missionkit.engine.planned_events import planned
from missionkit.errors import ExitCode


def run(order: RunOptions) -> ExitCode:
    """Fly the mission; leave a folder with its record, summary and picture.

    Raises:
        FileError: mission, world or plug-in file cannot be used.
        UsageError: an option does not fit, or there is nothing to resume.
        VehicleError: the vehicle could not be reached, or must not be commanded.
    """
    before = None if order.resume is None else found_origin(order.resume)
    if before is not None:
        order = recalled(order, before)
        check_plugins(order, before)
    catalogue = assemble(order.plugins)
    mission = load(order.mission, catalogue, overrides(order.settings))
    refuse(mission, catalogue)
    origins = _origins(order, mission, before)
    for text in order.events:
        planned(text, mission.by_name())
    if order.sitl is not None:
        return _in_sitl(order.sitl, order, mission, catalogue, origins)
    if order.vehicle is not None:
        from missionkit.cli.run_on_vehicle import run_on_vehicle  # noqa: PLC0415 heavy

        return run_on_vehicle(order, mission, catalogue, origins)
    from missionkit.cli.run_in_simulator import run_in_simulator  # noqa: PLC0415 quick if refused

    return run_in_simulator(order, mission, catalogue, origins)


def _in_sitl(
    dialect: str, order: RunOptions, mission: Mission, catalogue: Catalogue, origins: Origins
) -> ExitCode:
    """Fly a simulated autopilot that is there for this run alone."""
    from missionkit.api.vehicle_camera import RENDERED  # noqa: PLC0415 heavy
    from missionkit.cli.run_on_vehicle import run_on_vehicle  # noqa: PLC0415 heavy
    from missionkit.cli.simulated_autopilot import simulated_autopilot  # noqa: PLC0415 heavy

    speed, source = order.speed or 1.0, order.source
    if source is None and mission.camera.use == "device":
        source = RENDERED  # as in the simulator
    with simulated_autopilot(
        dialect,
        mission,
        order.mission.parent,
        speed=speed,
        seed=order.seed,
        faults=order.faults,
        system=order.system or 1,
    ) as address:
        flown = order._replace(vehicle=address, source=source, faults=(), speed=speed)
        return run_on_vehicle(flown, mission, catalogue, origins)


def _origins(order: RunOptions, mission: Mission, before: Origin | None) -> Origins:
    """Return what the run stands on; a changed mission is refused before anything is compiled."""
    now = origin_of(
        mission,
        order.mission,
        settings=order.settings,
        plugins=order.plugins,
        seed=order.seed,
        faults=order.faults,
    )
    if before is not None and order.resume is not None:
        check_same(before, now, order.resume, force=order.force)
    return Origins(now, before)
