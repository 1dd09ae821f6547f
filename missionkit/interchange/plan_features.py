"""A plan as points, lines and areas, each marked with what it is."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from typing import Any

from missionkit.interchange.features import Feature, Shape
from missionkit.interchange.plan import (
    Action,
    Corridor,
    Home,
    Land,
    LatLon,
    Place,
    Plan,
    Return,
    Survey,
    TakeOff,
    Turns,
    Waypoint,
)


def features_of(plan: Plan) -> Iterator[Feature]:
    """Yield everything in a plan; routes are drawn as lines too.

    Args:
        plan: with home.
    """
    home = plan.home or Home(0.0, 0.0, 0.0)
    yield _feature(-1, "home", (Place(*home[:2], home.alt, "amsl"),))
    for action in plan.actions:
        yield _of(action, Place(*home[:2], 0.0, "above_home"))
    for kind, group in groupby(plan.actions, type):
        route = tuple(it.place for it in group if isinstance(it, Waypoint))
        if kind is Waypoint and len(route) > 1:
            yield _feature(-1, "drawing", route, shape="line")
    for each in plan.rally:
        yield _feature(each.item, "rally", (each.place,), _height(each.place))
    if plan.fence is not None:
        ceiling = {} if plan.fence.height is None else {"ceiling": plan.fence.height}
        outline = _level(plan.fence.outline)
        yield _feature(plan.fence.item, "fence", outline, ceiling, shape="area")
        for corners, item in plan.fence.holes:
            yield _feature(item, "hole", _level(corners), shape="area")


def _of(action: Action, home: Place) -> Feature:
    match action:
        case Waypoint():
            return _feature(action.item, "waypoint", (action.place,), _waypoint(action))
        case Turns():
            return _feature(action.item, "circle", (action.place,), _circle(action))
        case Survey():
            mark = _lines(action) | ({} if action.angle is None else {"angle": action.angle})
            return _feature(action.item, "survey", _at(action.polygon, action), mark, shape="area")
        case Corridor():
            mark = _lines(action) | {"breadth": action.breadth}
            return _feature(action.item, "corridor", _at(action.line, action), mark, shape="line")
        case _:
            return _end(action, home)


def _end(action: TakeOff | Return | Land, home: Place) -> Feature:
    """Return the take-off, the return or the landing, which are drawn at home."""
    match action:
        case TakeOff():
            place = home._replace(height=action.height)
            return _feature(action.item, "take-off", (place,), {"height": action.height})
        case Return():
            return _feature(action.item, "return", (home,))
        case Land():
            here = action.spot is None
            place = home if action.spot is None else Place(*action.spot, 0.0, "above_home")
            return _feature(action.item, "land", (place,), {"here": True} if here else {})


def _circle(action: Turns) -> dict[str, Any]:
    values = {"radius": action.radius, "turns": action.turns, "speed": action.speed}
    return _height(action.place) | values | {"clockwise": action.clockwise}


def _feature(
    item: int,
    role: str,
    places: tuple[Place, ...],
    mark: dict[str, Any] | None = None,
    *,
    shape: Shape = "point",
) -> Feature:
    return Feature(item, shape, places, (), {"role": role, **(mark or {})}, role)


def _height(place: Place) -> dict[str, Any]:
    return {"height": place.height, "reference": place.reference}


def _waypoint(it: Waypoint) -> dict[str, Any]:
    mark = _height(it.place) | {"speed": it.speed}
    if it.wait:
        mark["wait"] = it.wait
    if it.heading is not None:
        mark["heading"] = it.heading
    if it.photo:
        mark["photo"] = True
    if it.look_at is not None:
        mark["look_at"] = list(it.look_at)
    if it.stop:
        mark["stop"] = True
    return mark


def _lines(action: Survey | Corridor) -> dict[str, Any]:
    return {
        "height": action.height,
        "spacing": action.spacing,
        "turn_around": action.turn_around,
        "speed": action.speed,
    }


def _level(corners: tuple[LatLon, ...]) -> tuple[Place, ...]:
    return tuple(Place(*it) for it in corners)


def _at(corners: tuple[LatLon, ...], action: Survey | Corridor) -> tuple[Place, ...]:
    return tuple(Place(*it, action.height, "above_home") for it in corners)
