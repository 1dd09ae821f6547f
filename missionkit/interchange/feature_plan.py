"""Points, lines and areas as a plan."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, Literal, TypeAlias

from missionkit.geodesy import Origin
from missionkit.interchange.bounded_input import ForeignFileError, number
from missionkit.interchange.features import MOST_POINTS, Feature
from missionkit.interchange.fence_shapes import FenceShapes, open_ring
from missionkit.interchange.ledger import Ledger, Outcome
from missionkit.interchange.lines import local
from missionkit.interchange.plan import (
    Action,
    Corridor,
    Fence,
    Home,
    Land,
    LatLon,
    Place,
    Plan,
    Rally,
    Reference,
    Return,
    Survey,
    TakeOff,
    Turns,
    Waypoint,
    degrees,
    metres,
)
from missionkit.polygons import area

Areas: TypeAlias = Literal["survey", "fence"]
REFERENCES: tuple[Reference, ...] = ("above_home", "amsl", "agl", "ellipsoid", "none")
NOT_OURS = "its mark says a {!r}, whose values are missing"


def plan_of(features: Iterable[Feature], areas: Areas, ledger: Ledger) -> Plan:
    """Return what features stand for: points and lines are flown to, areas surveyed.

    Args:
        features: in order; what missionkit has written says itself what it is.
        areas: what an area without such a mark is.
        ledger: with their entries.

    Raises:
        ForeignFileError: they are too many.
    """
    rows = list(features)
    if sum(len(it.places) for it in rows) > MOST_POINTS:
        raise ForeignFileError(f"more than {MOST_POINTS} points: make it simpler first")
    home: Home | None = None
    shapes, rally, actions, ceiling = FenceShapes(), [], list[Action](), None
    for it in rows:
        role = str(it.mark.get("role", ""))[:40]
        if role == "home":
            altitude = number(it.mark.get("altitude"))
            high = it.places[0].height if altitude is None else metres(altitude)
            home = Home(*it.places[0].spot, high)
        elif role == "rally":
            rally += _rally(it, ledger)
        elif role in {"fence", "hole"} or (not role and it.shape == "area" and areas == "fence"):
            _fence(it, shapes, ledger)
            ceiling = number(it.mark.get("ceiling")) or ceiling
        elif role == "drawing":
            ledger.remark(it.item, "a drawing of the places beside it")
        else:
            actions += _actions(it, role, ledger)
    fence: Fence | None = shapes.fence(ledger)
    if fence is not None:
        fence = fence._replace(height=ceiling)
    return Plan(home, tuple(actions), fence, tuple(rally))


def _rally(it: Feature, ledger: Ledger) -> list[Rally]:
    try:
        return [Rally(_place(it), it.item)]
    except ValueError:
        ledger.refuse(it.item, NOT_OURS.format("rally"))
        return []


def _fence(it: Feature, shapes: FenceShapes, ledger: Ledger) -> None:
    inward = it.mark.get("role") != "hole"
    shapes.polygon(tuple(each.spot for each in it.places), it.item, ledger, inward=inward)
    for hole in it.holes:
        shapes.polygon(tuple(each.spot for each in hole), it.item, ledger, inward=False)


def _actions(it: Feature, role: str, ledger: Ledger) -> list[Action]:
    reader = _MARKED.get(role)
    if role and reader is None:
        ledger.refuse(it.item, f"its mark says a {role!r}, which is not known")
        return []
    try:
        return [reader(it)] if reader is not None else _plain(it, ledger)
    except (TypeError, ValueError):
        ledger.refuse(it.item, NOT_OURS.format(role))
        return []


def _plain(it: Feature, ledger: Ledger) -> list[Action]:
    """Return what an unmarked feature is."""
    if it.shape != "area":
        return [Waypoint(each, it.item) for each in it.places]
    ring = open_ring(tuple(each.spot for each in it.places))
    if len(ring) < 3:
        ledger.refuse(it.item, "it does not have three corners")
        return []
    if it.holes:
        origin = Origin(*ring[0], 0.0)
        rings = (open_ring(tuple(each.spot for each in hole)) for hole in it.holes)
        within = sum(abs(area(local(hole, origin))) for hole in rings if len(hole) > 2)
        ledger.approximate(it.item, "its holes are surveyed too", metres(within), "m²")
    first = it.places[0]
    known = ledger.entries[it.item].outcome is not Outcome.REFUSED
    if known:
        ledger.remark(it.item, "an area to survey")
    return [Survey(ring, first.height, first.reference, it.item, exact=True)]


def _number(mark: Mapping[str, Any], key: str) -> float:
    """Return a number of a mark.

    Raises:
        ValueError: it is missing.
    """
    value = number(mark.get(key))
    if value is None:
        raise ValueError(key)
    return metres(value)


def _place(it: Feature) -> Place:
    """Return the place of a marked point: the mark names the reference of its height.

    The height itself is that of the geometry where it has one, which a user may have moved.
    """
    reference = it.mark.get("reference", "none")
    if reference not in REFERENCES:
        raise ValueError(reference)
    return Place(*it.places[0].spot, _height(it), reference)


def _height(it: Feature) -> float:
    drawn = it.places[0]
    if drawn.reference == "none":
        return _number(it.mark, "height")
    return metres(drawn.height - (number(it.mark.get("above")) or 0.0))


def _waypoint(it: Feature) -> Waypoint:
    look = it.mark.get("look_at")
    return Waypoint(
        _place(it),
        it.item,
        _number(it.mark, "speed"),
        number(it.mark.get("wait")) or 0.0,
        number(it.mark.get("heading")),
        photo=it.mark.get("photo") is True,
        look_at=None if look is None else _look(look),
        stop=it.mark.get("stop") is True,
    )


def _look(look: Any) -> Place:
    lat, lon, height, reference = look
    values = [number(value) for value in (lat, lon, height)]
    if None in values or reference not in REFERENCES:
        raise ValueError(look)
    north, east, up = (value or 0.0 for value in values)
    return Place(degrees(north), degrees(east), metres(up), reference)


def _take_off(it: Feature) -> TakeOff:
    return TakeOff(_height(it), "above_home", None, it.item)


def _circle(it: Feature) -> Turns:
    clockwise = it.mark.get("clockwise") is not False
    radius, turns, speed = (_number(it.mark, key) for key in ("radius", "turns", "speed"))
    return Turns(_place(it), radius, turns, it.item, clockwise, speed)


def _survey(it: Feature) -> Survey:
    angle = number(it.mark.get("angle"))
    height, spacing, turn, speed = _line_values(it)
    ring = open_ring(tuple(each.spot for each in it.places))
    return Survey(ring, height, "above_home", it.item, spacing, angle, turn, speed, exact=True)


def _corridor(it: Feature) -> Corridor:
    height, spacing, turn, speed = _line_values(it)
    breadth, line = _number(it.mark, "breadth"), tuple(each.spot for each in it.places)
    return Corridor(line, breadth, height, "above_home", it.item, spacing, turn, speed, exact=True)


def _line_values(it: Feature) -> tuple[float, float, float, float]:
    spacing, turn, speed = (_number(it.mark, key) for key in ("spacing", "turn_around", "speed"))
    return _height(it), spacing, turn, speed


def _return(it: Feature) -> Return:
    return Return(it.item)


def _land(it: Feature) -> Land:
    here = it.mark.get("here") is True
    return Land(None if here else LatLon(*it.places[0].spot), it.item)


_MARKED: Mapping[str, Callable[[Feature], Action]] = {
    "waypoint": _waypoint,
    "take-off": _take_off,
    "circle": _circle,
    "survey": _survey,
    "corridor": _corridor,
    "return": _return,
    "land": _land,
}
