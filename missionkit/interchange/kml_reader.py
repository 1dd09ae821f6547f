"""KML: placemarks with points, lines and areas. https://docs.ogc.org/is/12-007r2/12-007r2.html."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any
from xml.etree.ElementTree import Element

from missionkit.interchange.bounded_input import child, local, padded, words
from missionkit.interchange.features import MARK, Feature, Shape, place
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.plan import Place, Reference

MODES: Mapping[str, Reference] = {
    "absolute": "amsl",
    "relativeToGround": "agl",
    "clampToGround": "none",
    "": "none",
}
GEOMETRIES = ("Point", "LineString", "LinearRing", "Polygon", "MultiGeometry", "Track")
ELSEWHERE = {
    "GroundOverlay": "a picture on the ground",
    "ScreenOverlay": "a picture on the screen",
    "PhotoOverlay": "a picture",
    "NetworkLink": "it leads to another file, which is not fetched",
}


def read_kml(root: Element, ledger: Ledger) -> list[Feature]:
    """Return the features of a document in order.

    Args:
        root: of the document.
        ledger: gets an entry for each placemark, overlay and link.
    """
    found: list[Feature] = []
    for element in root.iter():
        tag = local(element)
        if tag in ELSEWHERE:
            ledger.refuse(ledger.open(_label(ledger), tag), ELSEWHERE[tag])
        elif tag == "Placemark":
            found += _placemark(element, ledger)
    return found


def _label(ledger: Ledger) -> str:
    return f"item {len(ledger.entries) + 1}"


def _placemark(element: Element, ledger: Ledger) -> list[Feature]:
    name = words(element, "name")[:60]
    geometry = next((it for it in element if local(it) in GEOMETRIES), None)
    what = "Placemark" if geometry is None else local(geometry)
    entry = ledger.open(_label(ledger), f"{what} {name!r}" if name else what)
    if geometry is None:
        ledger.refuse(entry, "it has no point, line or area")
        return []
    mark = _mark(element)
    found = []
    for part in _parts(geometry):
        feature = _feature(part, entry, mark, name)
        if feature is None:
            ledger.refuse(entry, "a coordinate of it is not lon,lat[,alt] on the earth")
            return []
        found.append(feature)
    return found


def _parts(geometry: Element) -> Iterator[Element]:
    if local(geometry) != "MultiGeometry":
        yield geometry
        return
    for each in geometry:
        if local(each) in GEOMETRIES:
            yield from _parts(each)


def _feature(geometry: Element, entry: int, mark: Mapping[str, Any], name: str) -> Feature | None:
    tag, mode = local(geometry), MODES.get(words(geometry, "altitudeMode"), "none")
    if tag == "Polygon":
        ring = child(geometry, "outerBoundaryIs", "LinearRing")
        rings = [] if ring is None else [ring]
        rings += [
            inner
            for it in geometry
            if local(it) == "innerBoundaryIs" and (inner := child(it, "LinearRing")) is not None
        ]
        read = [_coordinates(words(it, "coordinates"), mode) for it in rings]
        if not read or any(it is None for it in read):
            return None
        outer, *holes = (it for it in read if it is not None)
        return Feature(entry, "area", outer, tuple(holes), mark, name)
    if tag == "Track":
        rows = ((it.text or "").strip() for it in geometry if local(it) == "coord")
        places = _coordinates(" ".join(it.replace(" ", ",") for it in rows), mode)
    else:
        places = _coordinates(words(geometry, "coordinates"), mode)
    shape: Shape = "point" if tag == "Point" else "line"
    return None if not places else Feature(entry, shape, places, (), mark, name)


def _coordinates(text: str, reference: Reference) -> tuple[Place, ...] | None:
    """Return places written `lon,lat[,alt]`; clamped to the ground they have no height."""
    found = []
    for word in text.split():
        lon, lat, height = padded(word.split(","), 3)
        it = place(lon, lat, None if reference == "none" else height, reference)
        if it is None:
            return None
        found.append(it)
    return tuple(found)


def _mark(element: Element) -> Mapping[str, Any]:
    data = child(element, "ExtendedData")
    for it in () if data is None else data:
        if local(it) == "Data" and it.get("name") == MARK:
            return marked(words(it, "value"))
    return {}


def marked(text: str) -> Mapping[str, Any]:
    """Return what missionkit wrote about a feature, nothing if it is not JSON of a mapping."""
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}
