"""`missionkit run`: load, refuse what cannot be right, and fly."""

from __future__ import annotations

from missionkit.api.missions import assemble, refuse
from missionkit.api.run_origin import Origin, Origins, check_same, found_origin, origin_of
from missionkit.chart.load import load
from missionkit.chart.model.mission import Mission
from missionkit.cli.key_events import planned
from missionkit.cli.overrides import overrides
from missionkit.cli.recalled_options import check_plugins, recalled
from missionkit.cli.run_options import RunOptions
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
        planned(text)
    if order.vehicle is not None:
        from missionkit.cli.run_on_vehicle import run_on_vehicle  # noqa: PLC0415 heavy

        return run_on_vehicle(order, mission, catalogue, origins)
    from missionkit.cli.run_in_simulator import run_in_simulator  # noqa: PLC0415 quick if refused

    return run_in_simulator(order, mission, catalogue, origins)


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
