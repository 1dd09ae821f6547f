"""A plan as waylines of DJI (WPML)."""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree.ElementTree import Element, SubElement

from missionkit.geodesy import Origin
from missionkit.interchange.kml_writer import NAMESPACE, archive, document_bytes
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.lines import earth, flown
from missionkit.interchange.mavlink_items import refuse_shapes
from missionkit.interchange.mission_text import figure
from missionkit.interchange.plan import (
    Corridor,
    Home,
    Land,
    Place,
    Plan,
    Survey,
    TakeOff,
    Turns,
    Waypoint,
    metres,
)
from missionkit.interchange.waypoints_file import EXPANDED

WPML = "http://www.dji.com/wpmz/1.0.2"
STOP, PASS = "toPointAndStopWithDiscontinuityCurvature", "toPointAndPassWithContinuityCurvature"
LOWEST_SPEED = 0.1  # m/s


def wpml(plan: Plan, ledger: Ledger) -> bytes:
    """Return the archive.

    Args:
        plan: with home.
        ledger: where what it cannot say is noted.
    """
    home = plan.home or Home(0.0, 0.0, 0.0)
    refuse_shapes(plan, ledger, "WPML")
    places = [_level(it, home, ledger) for it in _waypoints(plan, home, ledger)]
    speed = next((it.speed for it in places if it.speed), 5.0)
    documents = []
    for name in ("template.kml", "waylines.wpml"):
        root = Element("kml", {"xmlns": NAMESPACE, "xmlns:wpml": WPML})
        document = SubElement(root, "Document")
        _config(document, plan, home, speed)
        folder = SubElement(document, "Folder")
        if name == "template.kml":
            _say(folder, "templateType", "waypoint")
            frame = SubElement(folder, "wpml:waylineCoordinateSysParam")
            _say(frame, "coordinateMode", "WGS84")
            _say(frame, "heightMode", "relativeToStartPoint")
        _say(folder, "templateId", "0")
        _say(folder, "executeHeightMode", "relativeToStartPoint")
        _say(folder, "waylineId", "0")
        _say(folder, "autoFlightSpeed", figure(speed))
        for index, it in enumerate(places):
            folder.append(_placemark(index, it))
        documents.append((f"wpmz/{name}", document_bytes(root)))
    return archive(documents)


def _waypoints(plan: Plan, home: Home, ledger: Ledger) -> Iterator[Waypoint]:
    origin = Origin(*home)
    for action in plan.actions:
        match action:
            case Waypoint():
                yield action
            case Survey() | Corridor():
                ledger.approximate(action.item, EXPANDED, 0.0)
                for spot in earth(flown(action, origin), origin):
                    here = Place(*spot, action.height, action.reference)
                    yield Waypoint(here, action.item, action.speed)
            case Turns():
                ledger.refuse(action.item, "a wayline has no circles")
            case Land(spot=spot) if spot is not None:
                ledger.approximate(action.item, "it lands where the wayline ends")
            case _:
                pass


def _level(it: Waypoint, home: Home, ledger: Ledger) -> Waypoint:
    """Return a waypoint with a height above home: a wayline names one reference for all."""
    place, look = it.place, it.look_at
    if look is not None and look.reference == "amsl":
        it = it._replace(look_at=look._replace(height=metres(look.height - home.alt)))
    if place.reference == "amsl":
        ledger.approximate(it.item, "its height is given above home", 0.0)
        height = metres(place.height - home.alt)
        return it._replace(place=place._replace(height=height, reference="above_home"))
    return it._replace(place=place._replace(reference="above_home"))


def _config(document: Element, plan: Plan, home: Home, speed: float) -> None:
    config = SubElement(document, "wpml:missionConfig")
    climb = next((it.height for it in plan.actions if isinstance(it, TakeOff)), 2.0)
    lands = plan.actions and isinstance(plan.actions[-1], Land)
    _say(config, "flyToWaylineMode", "safely")
    _say(config, "finishAction", "autoLand" if lands else "goHome")
    _say(config, "exitOnRCLost", "executeLostAction")
    _say(config, "executeRCLostAction", "goBack")
    _say(config, "takeOffSecurityHeight", figure(climb))
    _say(config, "takeOffRefPoint", ",".join(map(figure, home)))
    _say(config, "globalTransitionalSpeed", figure(speed))


def _placemark(index: int, it: Waypoint) -> Element:
    found = Element("Placemark")
    lat, lon, height = map(figure, it.place[:3])
    SubElement(SubElement(found, "Point"), "coordinates").text = f"{lon},{lat}"
    _say(found, "index", str(index))
    _say(found, "height", height)
    _say(found, "executeHeight", height)
    _say(found, "waypointSpeed", figure(max(it.speed or 0.0, LOWEST_SPEED)))
    heading = SubElement(found, "wpml:waypointHeadingParam")
    if it.look_at is not None:
        _say(heading, "waypointHeadingMode", "towardPOI")
        _say(heading, "waypointPoiPoint", ",".join(map(figure, it.look_at[:3])))
    elif it.heading is not None:
        _say(heading, "waypointHeadingMode", "smoothTransition")
        _say(heading, "waypointHeadingAngle", figure(it.heading - 360.0 * (it.heading > 180.0)))
    else:
        _say(heading, "waypointHeadingMode", "followWayline")
    turn = SubElement(found, "wpml:waypointTurnParam")
    _say(turn, "waypointTurnMode", STOP if it.stop or it.wait else PASS)
    _say(turn, "waypointTurnDampingDist", "0")
    _say(found, "useStraightLine", "1")
    if it.wait or it.photo:
        found.append(_actions(index, it))
    return found


def _actions(index: int, it: Waypoint) -> Element:
    group = Element("wpml:actionGroup")
    _say(group, "actionGroupId", str(index))
    _say(group, "actionGroupStartIndex", str(index))
    _say(group, "actionGroupEndIndex", str(index))
    _say(group, "actionGroupMode", "sequence")
    _say(SubElement(group, "wpml:actionTrigger"), "actionTriggerType", "reachPoint")
    wanted = [("hover", "hoverTime", figure(it.wait))] if it.wait else []
    wanted += [("takePhoto", "payloadPositionIndex", "0")] if it.photo else []
    for count, (what, key, value) in enumerate(wanted):
        action = SubElement(group, "wpml:action")
        _say(action, "actionId", str(count))
        _say(action, "actionActuatorFunc", what)
        _say(SubElement(action, "wpml:actionActuatorFuncParam"), key, value)
    return group


def _say(parent: Element, key: str, value: str) -> None:
    SubElement(parent, f"wpml:{key}").text = value
