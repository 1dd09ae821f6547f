"""Values as QGroundControl writes them in JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from missionkit.interchange.bounded_input import ForeignFileError, number
from missionkit.interchange.plan import LatLon, degrees


def section(data: Any, name: str) -> Mapping[str, Any]:
    """Return a mapping inside a mapping, an empty one if it is absent.

    Raises:
        ForeignFileError: it is something else.
    """
    found = data.get(name, {}) if isinstance(data, dict) else None
    if not isinstance(found, dict):
        raise ForeignFileError(f"'{name}' is not a mapping")
    return found


def listed(data: Mapping[str, Any], name: str) -> Sequence[Any]:
    """Return a list inside a mapping, an empty one if it is absent.

    Raises:
        ForeignFileError: it is something else.
    """
    found = data.get(name, [])
    if not isinstance(found, list):
        raise ForeignFileError(f"'{name}' is not a list")
    return found


def spot(row: object) -> LatLon | None:
    """Return a place written [lat, lon, ...], None if it is none."""
    if not isinstance(row, list) or len(row) < 2:
        return None
    lat, lon = number(row[0]), number(row[1])
    if lat is None or lon is None or abs(lat) > 90.0 or abs(lon) > 180.0:
        return None
    return LatLon(degrees(lat), degrees(lon))


def spots(rows: object) -> tuple[LatLon, ...] | None:
    """Return places written [lat, lon], None if one of them is none."""
    found = [spot(row) for row in rows] if isinstance(rows, list) else [None]
    return None if None in found else tuple(it for it in found if it is not None)
