"""GPX 1.1: waypoints, routes and tracks; elevations are above sea level."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from missionkit.geodesy import Origin
from missionkit.interchange.bounded_input import child, local, words
from missionkit.interchange.features import MARK, Feature, place
from missionkit.interchange.kml_reader import marked
from missionkit.interchange.kml_writer import document_bytes
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.lines import earth, flown
from missionkit.interchange.mavlink_items import refuse_shapes
from missionkit.interchange.mission_text import figure
from missionkit.interchange.plan import (
    Corridor,
    Home,
    Place,
    Plan,
    Survey,
    Turns,
    Waypoint,
    metres,
)
from missionkit.interchange.plan_features import features_of
from missionkit.interchange.waypoints_file import EXPANDED

NAMESPACE = "http://www.topografix.com/GPX/1/1"
OURS = "https://missionkit.invalid/gpx"
WRONG = "its lat and lon are not a place on the earth"


def read_gpx(root: Element, ledger: Ledger) -> list[Feature]:
    """Return waypoints, the points of routes, and the segments of tracks, in that order.

    Args:
        root: of the document.
        ledger: gets an entry for each of them.
    """
    found = [_point(it, ledger, "wpt") for it in root if local(it) == "wpt"]
    for route in (it for it in root if local(it) == "rte"):
        found += [_point(it, ledger, "rtept") for it in route if local(it) == "rtept"]
    for track in (it for it in root if local(it) == "trk"):
        found += [_segment(it, ledger) for it in track if local(it) == "trkseg"]
    return [it for it in found if it is not None]


def _point(element: Element, ledger: Ledger, tag: str) -> Feature | None:
    name = words(element, "name")[:60]
    label = f"item {len(ledger.entries) + 1}"
    entry = ledger.open(label, f"{tag} {name!r}" if name else tag)
    it = _place(element)
    if it is None:
        ledger.refuse(entry, WRONG)
        return None
    ours = child(element, "extensions", MARK)
    mark: Mapping[str, Any] = {} if ours is None else marked((ours.text or "").strip())
    return Feature(entry, "point", (it,), (), mark, name)


def _segment(element: Element, ledger: Ledger) -> Feature | None:
    points = [_place(it) for it in element if local(it) == "trkpt"]
    entry = ledger.open(f"item {len(ledger.entries) + 1}", f"trkseg of {len(points)} points")
    if not points or any(it is None for it in points):
        ledger.refuse(entry, WRONG if points else "it has no points")
        return None
    return Feature(entry, "line", tuple(it for it in points if it is not None))


def _place(element: Element) -> Place | None:
    return place(element.get("lon"), element.get("lat"), words(element, "ele") or None, "amsl")


def gpx(plan: Plan, name: str, ledger: Ledger) -> bytes:
    """Return a plan as a route; surveys as the places of their lines.

    Args:
        plan: with home.
        name: of the route.
        ledger: where what it cannot say is noted.
    """
    home = plan.home or Home(0.0, 0.0, 0.0)
    root = Element("gpx", {"xmlns": NAMESPACE, "version": "1.1", "creator": "missionkit"})
    refuse_shapes(plan, ledger, "GPX")
    route = Element("rte")
    SubElement(route, "name").text = name
    bare = plan._replace(actions=tuple(_route(plan, home, ledger)), fence=None, rally=())
    for each in features_of(bare):
        role = each.mark.get("role")
        if role == "drawing":
            continue
        parent, tag = (root, "wpt") if role == "home" else (route, "rtept")
        parent.append(_element(tag, each, home))
    root.append(route)
    return document_bytes(root)


def _route(plan: Plan, home: Home, ledger: Ledger) -> Iterator[Any]:
    """Yield the actions that are points; lines are expanded."""
    origin = Origin(*home)
    for action in plan.actions:
        if isinstance(action, Turns):
            ledger.refuse(action.item, "a route has no circles: its middle would be flown to")
        elif isinstance(action, Survey | Corridor):
            ledger.approximate(action.item, EXPANDED, 0.0)
            for spot in earth(flown(action, origin), origin):
                here = Place(*spot, action.height, action.reference)
                yield Waypoint(here, action.item, action.speed)
        else:
            yield action


def _element(tag: str, feature: Feature, home: Home) -> Element:
    it = feature.places[0]
    found = Element(tag, {"lat": figure(it.lat), "lon": figure(it.lon)})
    above = 0.0 if it.reference == "amsl" else home.alt
    SubElement(found, "ele").text = figure(metres(it.height + above))
    SubElement(found, "name").text = feature.name
    ours = SubElement(SubElement(found, "extensions"), MARK, {"xmlns": OURS})
    ours.text = json.dumps({**feature.mark, **({"above": above} if above else {})})
    return found
