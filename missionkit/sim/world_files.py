"""World files, by the kind of vehicle that flies in them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from missionkit.chart.model_file import load_model
from missionkit.chart.text.yaml_reader import read_file
from missionkit.errors import FileError, Place, Problem
from missionkit.import_on_demand import ImportedOnDemand

if TYPE_CHECKING:
    from missionkit.sim.free_flyer.world import FreeFlyerWorld
    from missionkit.sim.world import World

AnyWorld: TypeAlias = "World | FreeFlyerWorld"
_WORLDS: ImportedOnDemand[Any] = ImportedOnDemand(  # by the kind of vehicle
    {
        "sim": "missionkit.sim.world.World",
        "free_flyer": "missionkit.sim.free_flyer.world.FreeFlyerWorld",
    },
    lambda _, found: found,
)


def load_world(path: Path, kind: str, named_at: Place) -> AnyWorld:
    """Read a world file.

    Args:
        path: of the file.
        kind: of vehicle that is to fly in it.
        named_at: where the world is named, for messages.

    Raises:
        FileError: the file cannot be used, or is that of another kind of vehicle.
    """
    _require_kind(path, kind, named_at)
    return cast("AnyWorld", load_model(path, _WORLDS[kind]))


def load_multicopter_world(path: Path) -> World:
    """Read the file of a world that a multicopter flies in.

    Raises:
        FileError: the file cannot be used, or is that of another kind of vehicle.
    """
    _require_kind(path, "sim", Place(str(path), 1, 1))
    return cast("World", load_model(path, _WORLDS["sim"]))


def _require_kind(path: Path, kind: str, named_at: Place) -> None:
    found = _kind_of(path)
    if found != kind:
        wrong = f"world {path.name!r} is for vehicle {found!r}, not for {kind!r}"
        raise FileError([Problem(named_at, wrong)])


def _kind_of(path: Path) -> str:
    """Return the kind of vehicle a world is for; a multicopter's says none."""
    data = read_file(path).data
    vehicle = data.get("vehicle") if isinstance(data, dict) else None
    use = vehicle.get("use") if isinstance(vehicle, dict) else None
    return str(use) if isinstance(use, str) and use in _WORLDS else "sim"
