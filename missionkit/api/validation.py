"""Everything that is wrong with a mission: what refuses it, and what only deserves a look."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import BaseModel

from missionkit.api.missions import NO_SETTINGS, LoadedMission, as_yaml, assemble
from missionkit.chart.load import load
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_contracts import unmet
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.errors import FileError, Problem

if TYPE_CHECKING:
    from missionkit.sim.world_files import AnyWorld


def validate(
    mission: str | Path | LoadedMission,
    *,
    settings: Mapping[str, object] = NO_SETTINGS,
    plugins: Sequence[str | Path | type[BaseModel]] = (),
) -> tuple[Problem, ...]:
    """Check a mission file and return every problem, as `missionkit validate` does.

    Args:
        mission: path of the file, or a loaded mission.
        settings: values of the mission's `params`, as for `load`.
        plugins: classes or files of plug-ins, as for `load`.

    Returns:
        One `Problem` for each error, with its place (file, line, column), a sentence, its level
        (`error` or `warning`), a code and a remedy. Empty if there are none.

    Raises:
        UsageError: two plug-ins have the same name, or a class cannot be a plug-in.

    Example:
        >>> for problem in missionkit.validate("mission.yaml"):
        ...     print(problem.level, problem)
    """
    if isinstance(mission, LoadedMission):
        path, catalogue, values = mission.path, mission.catalogue, dict(mission.settings)
    else:
        path, values = Path(mission), as_yaml(settings)
        try:
            catalogue = assemble(plugins)
        except FileError as error:
            return error.problems
    return tuple(checked(path, catalogue, values)[1])


def checked(
    path: Path, catalogue: Catalogue, values: Mapping[str, str]
) -> tuple[Mission | None, list[Problem]]:
    """Return a mission, if its file can be read as one, and all that is wrong with it.

    Args:
        path: of the mission file.
        catalogue: what it may name.
        values: parameters by name, in YAML.
    """
    try:
        mission = load(path, catalogue, values)
    except FileError as error:
        return None, list(error.problems)
    world, problems = _world_of(path, mission)
    return mission, [*problems_of(mission, catalogue, world), *problems]


def problems_of(
    mission: Mission, catalogue: Catalogue, world: AnyWorld | None = None
) -> list[Problem]:
    """Return what is wrong with the chart of a mission, in the order of its files.

    Args:
        mission: a file that could be read.
        catalogue: what it may name.
        world: says how long a battery lasts, how full it is and how far a scan reaches, if known.
    """
    from missionkit.chart.checks import findings  # noqa: PLC0415 - heavy

    endurance, sight, charge = (None, None, 1.0) if world is None else _limits(world)
    found = {
        *unmet(mission, catalogue),
        *findings(mission, catalogue, endurance=endurance, charge=charge, sight=sight),
    }
    return sorted(found, key=_order)


def _order(problem: Problem) -> tuple[str, int, int, str, str]:
    place = problem.place
    return place.file, place.line, place.column, problem.code, problem.message


def _world_of(path: Path, mission: Mission) -> tuple[AnyWorld | None, Sequence[Problem]]:
    if mission.world is None:
        return None, ()
    from missionkit.sim.world_files import load_world  # noqa: PLC0415 - heavy

    place = mission.place("world")
    try:
        return load_world(path.parent / mission.world, mission.vehicle.use, place), ()
    except FileError as error:
        return None, error.problems


def _limits(world: AnyWorld) -> tuple[float | None, float | None, float]:
    """Return how long (s) a vehicle hovers, how far (m) its scanner sees, and its charge (0 to 1).

    None: it does not hover, it has no scanner.
    """
    from missionkit.sim.world import World  # noqa: PLC0415 - heavy

    if not isinstance(world, World):
        return None, None, 1.0
    joules = 3600.0 * world.battery.capacity * world.battery.charge
    hovers = joules / world.quadrotor.hovering
    return hovers, world.sensors.scan.range, world.battery.charge
