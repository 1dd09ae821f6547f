"""The tube of many flights as volumes in KML."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement

from missionkit.geodesy import Origin
from missionkit.interchange.flown_tube import Leg, Points, Visit, tube
from missionkit.interchange.kml_writer import NAMESPACE, document_bytes
from missionkit.interchange.mission_text import figure
from missionkit.interchange.plan import degrees, metres


class Level(NamedTuple):
    """A share of the flights, and its colour (aabbggrr)."""

    share: float
    colour: str


LEVELS = (Level(0.5, "b000a0ff"), Level(0.9, "6000c8ff"), Level(1.0, "3000e0ff"))


def tube_kml(paths: Mapping[Visit, Sequence[Points]], origin: Origin, name: str) -> bytes:
    """Return a document with a folder for each share of the flights, a volume for each visit.

    Args:
        paths: of all flights, by visit.
        origin: where [0, 0, 0] is.
        name: of the document.
    """
    root = Element("kml", {"xmlns": NAMESPACE})
    document = SubElement(root, "Document")
    SubElement(document, "name").text = name
    for level in LEVELS:
        style = SubElement(document, "Style", {"id": _style(level)})
        SubElement(SubElement(style, "PolyStyle"), "color").text = level.colour
        SubElement(SubElement(style, "LineStyle"), "width").text = "0"
    for level in LEVELS:
        folder = SubElement(document, "Folder")
        SubElement(folder, "name").text = f"{level.share:.0%} of the flights"
        for (state, visit), flown in paths.items():
            again = f", visit {visit}" if visit > 1 else ""
            mark = SubElement(folder, "Placemark")
            SubElement(mark, "name").text = f"{state}{again}"
            SubElement(mark, "description").text = f"{len(flown)} flights"
            SubElement(mark, "styleUrl").text = f"#{_style(level)}"
            shapes = SubElement(mark, "MultiGeometry")
            for leg in tube(flown, level.share):
                _add(shapes, leg, origin)
    return document_bytes(root)


def _style(level: Level) -> str:
    return f"share-{100 * level.share:.0f}"


def _add(shapes: Element, leg: Leg, origin: Origin) -> None:
    for face in leg.faces():
        polygon = SubElement(shapes, "Polygon")
        SubElement(polygon, "altitudeMode").text = "absolute"
        ring = SubElement(SubElement(polygon, "outerBoundaryIs"), "LinearRing")
        corners = [origin.place(corner) for corner in (*face, face[0])]
        SubElement(ring, "coordinates").text = " ".join(
            f"{figure(degrees(lon))},{figure(degrees(lat))},{figure(metres(alt))}"
            for lat, lon, alt in corners
        )
