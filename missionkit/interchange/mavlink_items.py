"""Actions of a plan as the items of a MAVLink mission."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from missionkit.geodesy import Origin
from missionkit.interchange import mavlink_commands as mav
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.lines import earth, flown
from missionkit.interchange.mavlink_commands import MISSION_FRAME, MissionItem, Params
from missionkit.interchange.plan import (
    Action,
    Corridor,
    Land,
    LatLon,
    Place,
    Plan,
    Return,
    Survey,
    TakeOff,
    Turns,
    Waypoint,
    degrees,
    metres,
)

GROUND_SPEED = 1.0  # param1 of DO_CHANGE_SPEED


@dataclass
class ItemWriter:
    """Writes action by action; DO items are added where something changes."""

    plan: Plan
    origin: Origin
    ledger: Ledger
    whole_lines: bool = False  # surveys are written as such by the caller
    speed: float | None = None
    look_at: Place | None = None
    at: tuple[float, float] = field(default=(0.0, 0.0))  # m, where the vehicle is by then

    def items(self, action: Action) -> Iterator[MissionItem]:
        """Yield the items of one action; those of a survey are its lines."""
        match action:
            case TakeOff():
                yield _at(mav.TAKE_OFF, Place(0.0, 0.0, action.height, "above_home"))
            case Waypoint():
                yield from self._waypoint(action)
            case Turns():
                yield from self.set_speed(action.speed)
                radius = action.radius if action.clockwise else -action.radius
                yield _at(mav.LOITER_TURNS, action.place, action.turns, 0.0, radius)
            case Survey() | Corridor():
                yield from self.set_speed(action.speed)
                yield from self.lines(action)
            case Return():
                yield MissionItem(mav.RETURN, MISSION_FRAME, _params())
            case Land():
                spot = action.spot or LatLon(0.0, 0.0)
                yield _at(mav.LAND, Place(*spot, 0.0, "above_home"))

    def set_speed(self, speed: float | None) -> Iterator[MissionItem]:
        """Yield an item that sets another speed, if it is one."""
        if speed is not None and speed != self.speed:
            self.speed = speed
            yield MissionItem(mav.CHANGE_SPEED, MISSION_FRAME, _params(GROUND_SPEED, speed, -1.0))

    def lines(self, action: Survey | Corridor) -> Iterator[MissionItem]:
        """Yield the places of the lines of a survey."""
        path = flown(action, self.origin, self.at)
        for spot in earth(path, self.origin):
            yield _at(mav.WAYPOINT, Place(*spot, action.height, action.reference))

    def _waypoint(self, action: Waypoint) -> Iterator[MissionItem]:
        yield from self.set_speed(action.speed)
        if action.look_at != self.look_at:
            self.look_at = at = action.look_at
            yield (
                MissionItem(mav.ROI_NONE, MISSION_FRAME, _params())
                if at is None
                else _at(mav.ROI_LOCATION, at)
            )
        stop = action.stop and action.heading is None
        command = mav.LOITER_TIME if stop else mav.WAYPOINT
        if action.stop and not stop:
            self.ledger.approximate(action.item, "it flies past the place")
        yield _at(command, action.place, action.wait, heading=action.heading)
        if action.photo:
            yield MissionItem(mav.IMAGE_START, MISSION_FRAME, _params(0.0, 0.0, 1.0))


def refuse_shapes(plan: Plan, ledger: Ledger, form: str) -> None:
    """Refuse the fence and the rally points where a format has none.

    Args:
        plan: with the entries they came from.
        ledger: of the export.
        form: the format.
    """
    entries = [it.item for it in plan.rally]
    if plan.fence is not None:
        entries += [plan.fence.item, *(item for _, item in plan.fence.holes)]
    for entry in entries:
        if entry >= 0:
            ledger.refuse(entry, f"{form} has no fence and no rally points")


def _at(
    command: int,
    place: Place,
    first: float = 0.0,
    second: float = 0.0,
    third: float = 0.0,
    heading: float | None = None,
) -> MissionItem:
    where = degrees(place.lat), degrees(place.lon), metres(place.height)
    frame = mav.FRAME_OF[place.reference]
    return MissionItem(command, frame, (first, second, third, heading, *where))


def _params(first: float = 0.0, second: float = 0.0, third: float = 0.0) -> Params:
    return first, second, third, 0.0, 0.0, 0.0, 0.0
