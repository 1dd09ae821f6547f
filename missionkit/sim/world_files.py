"""World files, by the kind of vehicle that flies in them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from missionkit.chart.load import load_model
from missionkit.chart.text.yaml_reader import read_file
from missionkit.errors import FileError, Place, Problem
from missionkit.sim.free_flyer.world import FreeFlyerWorld
from missionkit.sim.world import World

AnyWorld = World | FreeFlyerWorld
_WORLDS: Mapping[str, type[World] | type[FreeFlyerWorld]] = MappingProxyType(
    {"sim": World, "free_flyer": FreeFlyerWorld}
)


def load_world(path: Path, kind: str, named_at: Place) -> AnyWorld:
    """Read a world file.

    Args:
        path: of the file.
        kind: of vehicle, that the mission names.
        named_at: where the mission names the world.

    Raises:
        FileError: the file cannot be used, or is that of another kind of vehicle.
    """
    found = _kind_of(path)
    if found != kind:
        wrong = f"world {path.name!r} is for vehicle {found!r}, but the mission's is {kind!r}"
        raise FileError([Problem(named_at, wrong)])
    return load_model(path, _WORLDS[kind])


def _kind_of(path: Path) -> str:
    """Return the kind of vehicle a world is for; a multicopter's says none."""
    data = read_file(path).data
    vehicle = data.get("vehicle") if isinstance(data, dict) else None
    use = vehicle.get("use") if isinstance(vehicle, dict) else None
    return str(use) if vehicle is not None and use in _WORLDS else "sim"
