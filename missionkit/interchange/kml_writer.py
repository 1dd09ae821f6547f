"""KML and KMZ as Google Earth and ground stations read them."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from missionkit.interchange.features import MARK, Feature
from missionkit.interchange.mission_text import figure
from missionkit.interchange.plan import Place

NAMESPACE = "http://www.opengis.net/kml/2.2"
MODES = {"amsl": "absolute", "above_home": "relativeToGround", "agl": "relativeToGround"}
_LINE, _FILL = "ff1090f0", "401090f0"  # aabbggrr
_EPOCH = (1980, 1, 1, 0, 0, 0)  # of files in an archive: the same plan, the same bytes


def kml(features: Iterable[Feature], name: str) -> bytes:
    """Return a document with a placemark for each feature.

    Args:
        features: marked.
        name: of the document.
    """
    root = Element("kml", {"xmlns": NAMESPACE})
    document = SubElement(root, "Document")
    SubElement(document, "name").text = name
    style = SubElement(document, "Style", {"id": "plan"})
    line, fill = SubElement(style, "LineStyle"), SubElement(style, "PolyStyle")
    SubElement(line, "color").text, SubElement(line, "width").text = _LINE, "2"
    SubElement(fill, "color").text = _FILL
    for each in features:
        document.append(placemark(each))
    return document_bytes(root)


def document_bytes(root: Element) -> bytes:
    """Return a document as it stands in a file."""
    indent(root)
    found: bytes = tostring(root, encoding="utf-8", xml_declaration=True)
    return found + b"\n"


def placemark(feature: Feature) -> Element:
    """Return the placemark of a feature."""
    found = Element("Placemark")
    SubElement(found, "name").text = feature.name
    SubElement(found, "styleUrl").text = "#plan"
    if feature.mark:
        data = SubElement(SubElement(found, "ExtendedData"), "Data", {"name": MARK})
        SubElement(data, "value").text = json.dumps(dict(feature.mark))
    found.append(_geometry(feature))
    return found


def _geometry(feature: Feature) -> Element:
    tag = {"point": "Point", "line": "LineString", "area": "Polygon"}[feature.shape]
    found = Element(tag)
    mode = MODES.get(feature.places[0].reference, "clampToGround")
    SubElement(found, "altitudeMode").text = mode
    if feature.shape != "area":
        SubElement(found, "coordinates").text = _coordinates(feature.places)
        return found
    for tag, ring in (
        ("outerBoundaryIs", feature.places),
        *(("innerBoundaryIs", hole) for hole in feature.holes),
    ):
        inside = SubElement(SubElement(found, tag), "LinearRing")
        SubElement(inside, "coordinates").text = _coordinates((*ring, ring[0]))
    return found


def _coordinates(places: Iterable[Place]) -> str:
    return " ".join(
        ",".join(map(figure, (it.lon, it.lat, *(() if it.reference == "none" else (it.height,)))))
        for it in places
    )


def archive(files: Iterable[tuple[str, bytes]]) -> bytes:
    """Return a ZIP archive of files, the same bytes for the same files."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as found:
        for name, data in files:
            found.writestr(zipfile.ZipInfo(name, _EPOCH), data, zipfile.ZIP_DEFLATED)
    return stream.getvalue()
