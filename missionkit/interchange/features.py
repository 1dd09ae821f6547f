"""What KML, GeoJSON and GPX have in common: named points, lines and areas."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

from missionkit.interchange.bounded_input import number
from missionkit.interchange.plan import Place, Reference, degrees, metres

Shape: TypeAlias = Literal["point", "line", "area"]
MOST_POINTS = 20_000  # of one file
MARK = "missionkit"
"""Key of what missionkit adds to the features that it writes, so that it reads the same back."""


@dataclass(frozen=True)
class Feature:
    """One feature; an area has one ring of corners and perhaps holes."""

    item: int  # of the ledger
    shape: Shape
    places: tuple[Place, ...]
    holes: tuple[tuple[Place, ...], ...] = ()
    mark: Mapping[str, Any] = field(default_factory=dict)  # what missionkit wrote about it
    name: str = ""


def place(lon: object, lat: object, height: object, reference: Reference) -> Place | None:
    """Return a place, None if it is none on the earth; without a height if that is no number.

    Args:
        lon: deg, as the file has it.
        lat: deg.
        height: m.
        reference: of the height, where there is one.
    """
    east, north, up = number(lon), number(lat), number(height)
    if north is None or east is None or abs(north) > 90.0 or abs(east) > 180.0:
        return None
    if up is None:
        return Place(degrees(north), degrees(east))
    return Place(degrees(north), degrees(east), metres(up), reference)
