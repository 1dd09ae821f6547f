"""Loads the map of a mission together with it, so that its mistakes are reported before flight."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from pydantic import BaseModel, ValidationError

from missionkit.chart.model.mission import Mission
from missionkit.chart.model.validation_problems import plain, problems_in
from missionkit.chart.text.file_references import unfit
from missionkit.chart.text.located_data import LocatedTable, shown
from missionkit.chart.text.yaml_reader import read_file
from missionkit.errors import FileError, Place, Problem
from missionkit.messages import CameraModel, Occupancy, Spot
from missionkit.planning.map_section import MOST_CELLS
from missionkit.planning.map_server import MapFile
from missionkit.plugin import Behavior
from missionkit.plugin_containment import PluginError, is_foreign, reporting_faults
from missionkit.plugin_protocols import BehaviorProtocol

if TYPE_CHECKING:
    from missionkit.perception.map_image import Shades

M = TypeVar("M", bound=BaseModel)
Files = tuple[Path, ...]
MOST_BYTES = 64_000_000  # of an image


def read(mission: Mission, folder: Path) -> tuple[Occupancy | None, Files]:
    """Return a mission's map, and the files it was read from.

    Args:
        mission: as its file says.
        folder: of that file; nothing outside it is read.

    Raises:
        FileError: the map cannot be used.
    """
    section = mission.map
    if section is None or section.file is None:
        return (None if section is None else section.drawn()), ()
    place = mission.place("map")
    path = _inside(folder, folder, section.file, place)
    meta = _meta(path)
    image = _inside(folder, path.parent, meta.image, Place(str(path), 1, 1))
    return meta.read(_shades(image, place)), (path, image)


def problems_of(mission: Mission) -> Iterator[Problem]:
    """Yield what a mission wants on its map, or with its camera, that cannot be."""
    spots = {name: target.position[:2] for name, target in mission.targets.items()}
    camera = mission.camera.model()
    for name, state, _ in mission.walk():
        if state.behavior is None:
            continue
        wrong = _unfit(state.behavior.plugin, mission.known, spots, camera)
        if wrong:
            kind = state.behavior.kind
            yield Problem(state.place("behavior"), f"state {name!r}: {kind}: {wrong}")


def _unfit(
    plugin: BehaviorProtocol,
    known: Occupancy | None,
    spots: Mapping[str, Spot],
    camera: CameraModel,
) -> str:
    if isinstance(plugin, Behavior) and not is_foreign(plugin):
        try:
            return plugin.with_camera(camera).unfit(known, spots)
        except ValueError as error:
            return str(error)
    try:
        with reporting_faults():
            return plugin.unfit(known, spots)
    except PluginError as error:
        return f"unfit raised {error}"


def _inside(root: Path, folder: Path, name: str, place: Place) -> Path:
    path = folder / name
    if wrong := unfit(root, path):
        raise FileError([Problem(place, f"map {shown(name)}: {wrong}")])
    return path


def _meta(path: Path) -> MapFile:
    document = read_file(path)
    if document.problems or not isinstance(document.data, LocatedTable):
        wrong = Problem(document.start, f"expected a mapping, got {shown(document.data)}")
        raise FileError(document.problems or [wrong])
    try:
        return plain(MapFile, document.data)
    except ValidationError as error:
        found = problems_in(error, MapFile, document.data, document.start, {})
        raise FileError(found) from error


def _shades(path: Path, place: Place) -> Shades:
    from missionkit.perception.map_image import decode_shades  # noqa: PLC0415

    try:
        return decode_shades(_bytes(path), MOST_CELLS)
    except (OSError, ValueError) as error:
        raise FileError([Problem(place, f"map image {path.name}: {error}")]) from error


def _bytes(path: Path) -> bytes:
    if path.stat().st_size > MOST_BYTES:
        raise ValueError(f"it has more than {MOST_BYTES // 1_000_000} MB")
    return path.read_bytes()
