"""GeoJSON (RFC 7946): features with points, lines and areas."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from missionkit.interchange.bounded_input import ForeignFileError
from missionkit.interchange.features import MARK, Feature, Shape, place
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.plan import Place, degrees

POINTS, LINES, AREAS = (
    ("Point", "MultiPoint"),
    ("LineString", "MultiLineString"),
    ("Polygon", "MultiPolygon"),
)
DEPTH = {"Point": 0, "MultiPoint": 1, "LineString": 1, "MultiLineString": 2, "Polygon": 2}
DEPTH["MultiPolygon"] = 3
WRONG = "a coordinate of it is not [longitude, latitude] or [.., .., height] on the earth"


def read_geojson(data: Any, ledger: Ledger) -> list[Feature]:
    """Return the features of a document in order.

    Args:
        data: as JSON has it.
        ledger: gets an entry for each feature.

    Raises:
        ForeignFileError: it is no GeoJSON.
    """
    if not isinstance(data, dict):
        raise ForeignFileError("GeoJSON is a mapping with a 'type'")
    rows = data.get("features") if data.get("type") == "FeatureCollection" else [data]
    if not isinstance(rows, list):
        raise ForeignFileError("'features' is not a list")
    found: list[Feature] = []
    for count, row in enumerate(rows, 1):
        found += _row(row, count, ledger)
    return found


def _row(row: Any, count: int, ledger: Ledger) -> list[Feature]:
    feature = isinstance(row, dict) and row.get("type") == "Feature"
    geometry = row.get("geometry") if feature else row
    properties = row.get("properties") if feature else None
    properties = properties if isinstance(properties, dict) else {}
    name = str(properties.get("name", ""))[:60]
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    kind = kind if isinstance(kind, str) else None
    what = f"{str(kind)[:40]} {name!r}" if name else str(kind)[:40]
    entry = ledger.open(f"feature {count}", what)
    mark = properties.get(MARK)
    mark = mark if isinstance(mark, dict) else {}
    found = list(_parts(geometry, entry, mark, name))
    if not found or any(it is None for it in found):
        ledger.refuse(entry, WRONG if kind in DEPTH else "it has no point, line or area")
        return []
    return [it for it in found if it is not None]


def _parts(
    geometry: Any, entry: int, mark: Mapping[str, Any], name: str
) -> Iterator[Feature | None]:
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    if kind == "GeometryCollection" and isinstance(geometry.get("geometries"), list):
        for each in geometry["geometries"]:
            yield from _parts(each, entry, mark, name)
        return
    if not isinstance(kind, str) or kind not in DEPTH:
        yield None
        return
    coordinates = geometry.get("coordinates")
    parts = coordinates if kind.startswith("Multi") else [coordinates]
    for part in parts if isinstance(parts, list) else [None]:
        yield _part(part, kind, entry, mark, name)


def _part(part: Any, kind: str, entry: int, mark: Mapping[str, Any], name: str) -> Feature | None:
    """Return a feature of one point, line or area.

    Args:
        part: coordinates.
        kind: of the geometry.
        entry: of the ledger.
        mark: what missionkit wrote about it.
        name: of the feature.
    """
    if kind in AREAS:
        rings = [_places(it) for it in part] if isinstance(part, list) else []
        if not rings or any(not it for it in rings):
            return None
        outer, *holes = (it for it in rings if it is not None)
        return Feature(entry, "area", outer, tuple(holes), mark, name)
    places = _places([part] if kind in POINTS else part)
    shape: Shape = "point" if kind in POINTS else "line"
    return None if not places else Feature(entry, shape, places, (), mark, name)


def _places(rows: Any) -> tuple[Place, ...] | None:
    if not isinstance(rows, list):
        return None
    found = []
    for row in rows:
        if not isinstance(row, list) or len(row) < 2:
            return None
        it = place(row[0], row[1], row[2] if len(row) > 2 else None, "ellipsoid")
        if it is None:
            return None
        found.append(it)
    return tuple(found)


def geojson(features: Iterable[Feature], name: str) -> str:
    """Return a FeatureCollection.

    Heights stand in the marks, by name, and not in the coordinates, where the standard means those
    above the ellipsoid.

    Args:
        features: marked.
        name: of the collection.
    """
    rows = [
        {
            "type": "Feature",
            "properties": {"name": it.name, MARK: {**it.mark, **_home_height(it)}},
            "geometry": _geometry(it),
        }
        for it in features
    ]
    whole = {"type": "FeatureCollection", "name": name, "features": rows}
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


def _home_height(it: Feature) -> dict[str, float]:
    return {"altitude": it.places[0].height} if it.mark.get("role") == "home" else {}


def _geometry(it: Feature) -> dict[str, Any]:
    rows = [[degrees(each.lon), degrees(each.lat)] for each in it.places]
    match it.shape:
        case "point":
            return {"type": "Point", "coordinates": rows[0]}
        case "line":
            return {"type": "LineString", "coordinates": rows}
        case "area":
            rings = [[*rows, rows[0]]]
            rings += [[[each.lon, each.lat] for each in (*hole, hole[0])] for hole in it.holes]
            return {"type": "Polygon", "coordinates": rings}
