"""Waylines of DJI (WPML): an archive with wpmz/waylines.wpml and wpmz/template.kml.

The waylines are what a drone flies; the template is read where there are none.
https://developer.dji.com/doc/cloud-api-tutorial/en/api-reference/dji-wpml/overview.html
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from xml.etree.ElementTree import Element

from missionkit.interchange.bounded_input import child, local, number, padded, words
from missionkit.interchange.features import place
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.mavlink_actions import PHOTO_TIME
from missionkit.interchange.plan import (
    Action,
    Home,
    Land,
    Place,
    Plan,
    Reference,
    Return,
    TakeOff,
    Waypoint,
    metres,
)

HEIGHT_MODES: Mapping[str, Reference] = {
    "relativeToStartPoint": "above_home",
    "EGM96": "amsl",
    "WGS84": "ellipsoid",
    "aboveGroundLevel": "agl",
    "realTimeFollowSurface": "agl",
}
STOPS = "toPointAndStop"
ENDS = {
    "noAction": "it hovers at the end without limit",
    "gotoFirstWaypoint": "it flies to its first place and hovers there without limit",
}


@dataclass
class WaylineReader:
    """Reads one document, placemark by placemark."""

    ledger: Ledger
    undulation: float | None  # m, of the geoid above the ellipsoid, where the template says so
    actions: list[Action] = field(default_factory=list)

    def placemark(self, element: Element, folder: Element) -> None:
        """Add a place and what is done there, or refuse it in the ledger."""
        index = words(element, "index") or str(len(self.actions))
        entry = self.ledger.open(f"waypoint {index}", "Placemark")
        text = words(element, "Point", "coordinates").split(",")
        lon, lat = padded(text, 2)
        height, reference = self._height(element, folder)
        at = place(lon, lat, height, reference)
        if at is None:
            self.ledger.refuse(entry, "it has no point lon,lat on the earth")
            return
        speed = _own(element, folder, "waypointSpeed", "useGlobalSpeed", "autoFlightSpeed")
        stop = words(element, "waypointTurnParam", "waypointTurnMode").startswith(STOPS)
        heading, look = self._heading(element, entry)
        speed = metres(speed) if speed and speed > 0.0 else None
        waypoint = Waypoint(at, entry, speed, 0.0, heading, look_at=look, stop=stop)
        for action in _actions(element):
            waypoint = self._act(action, waypoint, index)
        self.actions.append(waypoint._replace(stop=waypoint.stop and waypoint.wait == 0.0))

    def _height(self, element: Element, folder: Element) -> tuple[float | None, Reference]:
        mode = words(folder, "executeHeightMode")
        if mode:
            height = number(words(element, "executeHeight"))
        else:
            mode = words(folder, "waylineCoordinateSysParam", "heightMode")
            height = _own(element, folder, "height", "useGlobalHeight", "globalHeight")
        reference = HEIGHT_MODES.get(mode, "none")
        if reference == "ellipsoid" and self.undulation is not None and height is not None:
            return height - self.undulation, "amsl"
        return (None if reference == "none" else height), reference

    def _heading(self, element: Element, entry: int) -> tuple[float | None, Place | None]:
        how = child(element, "waypointHeadingParam")
        mode = "" if how is None else words(how, "waypointHeadingMode")
        if how is not None and mode == "smoothTransition":
            angle = number(words(how, "waypointHeadingAngle"))
            return (None if angle is None else metres(angle % 360.0)), None
        if how is not None and mode == "towardPOI":
            lat, lon, up = padded(words(how, "waypointPoiPoint").split(","), 3)
            return None, place(lon, lat, up or 0.0, "above_home")
        if mode in {"fixed", "manually"}:
            self.ledger.approximate(entry, f"heading {mode!r}: along the course")
        return None, None

    def _act(self, action: Element, waypoint: Waypoint, index: str) -> Waypoint:
        """Return a waypoint with an action, an item of its own."""
        what = words(action, "actionActuatorFunc")[:40] or "action"
        entry = self.ledger.open(f"waypoint {index}", what)
        if what == "hover":
            seconds = number(words(action, "actionActuatorFuncParam", "hoverTime")) or 0.0
            if seconds > 0.0:
                return waypoint._replace(wait=metres(waypoint.wait + seconds))
        if what == "takePhoto":
            self.ledger.approximate(entry, "the camera is on while it waits", PHOTO_TIME, "s")
            return waypoint._replace(photo=True, wait=max(waypoint.wait, PHOTO_TIME))
        self.ledger.refuse(entry, f"a mission does nothing like {what} at a place")
        return waypoint


def read_wpml(waylines: Element | None, template: Element | None, ledger: Ledger) -> Plan:
    """Return the plan in the documents of an archive.

    Args:
        waylines: root of waylines.wpml.
        template: root of template.kml.
        ledger: gets an entry for each waypoint, each action, the take-off and the end.
    """
    main = waylines if waylines is not None else template
    if main is None:
        return Plan(None)
    reader = WaylineReader(ledger, _undulation(template))
    home = _home(template, waylines, ledger, reader.undulation)
    config = _config(main)
    if config is not None:
        _take_off(config, reader)
    for folder in (it for it in main.iter() if local(it) == "Folder"):
        marks = [it for it in folder if local(it) == "Placemark"]
        for mark in marks:
            if child(mark, "Point") is None:
                kind = words(folder, "templateType") or "area"
                entry = ledger.open(f"item {len(ledger.entries) + 1}", kind[:40])
                ledger.refuse(entry, "a template without its waylines: export it with them")
            else:
                reader.placemark(mark, folder)
    if config is not None:
        _end(config, reader)
    return Plan(home, tuple(reader.actions))


def _config(root: Element) -> Element | None:
    return next((it for it in root.iter() if local(it) == "missionConfig"), None)


def _undulation(template: Element | None) -> float | None:
    """Return how high the geoid is above the ellipsoid (m), by a place with both heights."""
    for folder in () if template is None else template.iter():
        if words(folder, "waylineCoordinateSysParam", "heightMode") != "EGM96":
            continue
        for mark in folder:
            above = number(words(mark, "ellipsoidHeight"))
            height = number(words(mark, "height"))
            if above is not None and height is not None:
                return above - height
    return None


def _home(
    template: Element | None, waylines: Element | None, ledger: Ledger, undulation: float | None
) -> Home | None:
    for root in (waylines, template):
        config = None if root is None else _config(root)
        text = "" if config is None else words(config, "takeOffRefPoint")
        if not text:
            continue
        entry = ledger.open("take-off point", "takeOffRefPoint")
        lat, lon, alt = padded(text.split(","), 3)
        at = place(lon, lat, alt, "ellipsoid")
        if at is None or at.reference == "none":
            ledger.refuse(entry, "expected latitude,longitude,height")
            return None
        return Home(*at.spot, metres(at.height - (undulation or 0.0)))
    return None


def _take_off(config: Element, reader: WaylineReader) -> None:
    height = number(words(config, "takeOffSecurityHeight"))
    if height is not None and height > 0.0:
        entry = reader.ledger.open("take-off", "takeOffSecurityHeight")
        reader.actions.append(TakeOff(metres(height), "above_home", None, entry))


def _end(config: Element, reader: WaylineReader) -> None:
    what = words(config, "finishAction")[:40]
    if not what:
        return
    entry = reader.ledger.open("end", f"finishAction {what}")
    if what == "goHome":
        reader.actions.append(Return(entry))
    elif what == "autoLand":
        reader.actions.append(Land(None, entry))
    else:
        reader.ledger.refuse(entry, ENDS.get(what, "it is not known"))


def _own(element: Element, folder: Element, key: str, use: str, shared: str) -> float | None:
    """Return a value of a placemark, or that of its folder.

    Args:
        element: the placemark.
        folder: around it.
        key: of the placemark's own value.
        use: of the flag that says to take the folder's.
        shared: of the folder's value.
    """
    own = number(words(element, key))
    return own if own is not None and words(element, use) != "1" else number(words(folder, shared))


def _actions(element: Element) -> Iterator[Element]:
    for group in (it for it in element if local(it) == "actionGroup"):
        yield from (it for it in group if local(it) == "action")
