"""The items of a MAVLink mission as actions of a plan."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

from missionkit.interchange import mavlink_commands as mav
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.mavlink_commands import MissionItem
from missionkit.interchange.plan import (
    Action,
    Land,
    LatLon,
    Place,
    Reference,
    Return,
    TakeOff,
    Turns,
    Waypoint,
    degrees,
    metres,
)

PHOTO_TIME = 1.0  # s at rest, with the camera on
RADIUS = 3.0  # m, of `waypoints`
AFTER_LANDING = "it comes after the landing"
WITHOUT_PLACE = "it has no latitude and longitude"


@dataclass
class ItemReader:
    """Reads item by item; what a DO item has set holds for those that follow."""

    ledger: Ledger
    zero_yaw_is_free: bool  # ArduPilot's files write 0 for a heading that is not given
    actions: list[Action] = field(default_factory=list)
    speed: float | None = None
    look_at: Place | None = None

    def take(self, item: MissionItem) -> None:
        """Add one item, or refuse it in the ledger."""
        if self.landed:
            self.ledger.refuse(item.item, AFTER_LANDING)
            return
        wrong = _READERS.get(item.command, _unknown)(self, item)
        if wrong:
            self.ledger.refuse(item.item, wrong)
        elif not item.proceeds:
            self.ledger.approximate(item.item, "it does not wait for the operator there")

    @property
    def landed(self) -> bool:
        """Whether the vehicle has landed by what was read so far."""
        return bool(self.actions) and isinstance(self.actions[-1], Return | Land)


def read_items(
    items: Iterable[MissionItem], ledger: Ledger, *, zero_yaw_is_free: bool
) -> tuple[Action, ...]:
    """Return the actions of a list of items.

    Args:
        items: each with its entry of the ledger.
        ledger: what is refused or approximated is noted there.
        zero_yaw_is_free: a heading of 0 stands for none.
    """
    reader = ItemReader(ledger, zero_yaw_is_free)
    for item in items:
        reader.take(item)
    return tuple(reader.actions)


def _unknown(_: ItemReader, item: MissionItem) -> str:
    return mav.REASONS.get(item.command, f"a mission has nothing like {mav.name_of(item.command)}")


def _spot(item: MissionItem) -> LatLon | None:
    """Return latitude and longitude; 0, 0 and NaN stand for none."""
    lat, lon = item.params[4:6]
    if lat is None or lon is None or (lat == 0.0 and lon == 0.0):
        return None
    return LatLon(degrees(lat), degrees(lon))


def _height(reader: ItemReader, item: MissionItem) -> tuple[float, Reference] | str:
    """Return a height and what it is measured from, or why there is none."""
    reference, height = mav.FRAMES.get(item.frame), item.params[6]
    if reference is None:
        return f"MAV_FRAME {item.frame} does not name a height that a mission can fly"
    if height is None:
        return "its height is not a number"
    if reference == "agl" and item.amsl is not None:
        reader.ledger.approximate(
            item.item, "terrain is followed at the places alone, by the plan's own heights", 0.0
        )
        return metres(item.amsl), "amsl"
    return metres(height), reference


def _place(reader: ItemReader, item: MissionItem) -> Place | str:
    spot = _spot(item)
    if spot is None:
        return WITHOUT_PLACE
    if abs(spot.lat) > 90.0 or abs(spot.lon) > 180.0:
        return f"{spot.lat:g}, {spot.lon:g} is not a place on the earth"
    height = _height(reader, item)
    return height if isinstance(height, str) else Place(*spot, *height)


def _waypoint(reader: ItemReader, item: MissionItem) -> str:
    place = _place(reader, item)
    if isinstance(place, str):
        return place
    hold, accepted, by = (value or 0.0 for value in item.params[:3])
    if hold < 0.0:
        return f"it holds for {hold:g} s"
    timed = item.command == mav.LOITER_TIME
    if not timed and accepted > 0.0 and accepted != RADIUS:
        reader.ledger.approximate(
            item.item, f"it turns up to {RADIUS:g} m before", abs(accepted - RADIUS)
        )
    if not timed and by:
        reader.ledger.approximate(item.item, "it is passed over, not beside", abs(by))
    heading = None if timed else _heading(reader, item)
    reader.actions.append(
        Waypoint(
            place,
            item.item,
            reader.speed,
            metres(hold),
            heading,
            look_at=reader.look_at,
            stop=timed and hold == 0.0,
        )
    )
    return ""


def _heading(reader: ItemReader, item: MissionItem) -> float | None:
    yaw = item.params[3]
    if yaw is None or reader.look_at is not None or (reader.zero_yaw_is_free and yaw == 0.0):
        return None
    return metres(yaw % 360.0)


def _take_off(reader: ItemReader, item: MissionItem) -> str:
    if any(not isinstance(it, TakeOff) for it in reader.actions):
        return "the vehicle is in the air already"
    if reader.actions:
        return "a second take-off"
    height = _height(reader, item)
    if isinstance(height, str):
        return height
    reader.actions.append(TakeOff(*height, _spot(item), item.item))
    return ""


def _turns(reader: ItemReader, item: MissionItem) -> str:
    place = _place(reader, item)
    if isinstance(place, str):
        return place
    turns, _, radius = (value or 0.0 for value in item.params[:3])
    if turns <= 0.0 or radius == 0.0:
        return f"{turns:g} turns at a radius of {radius:g} m: give both"
    turn = Turns(place, metres(abs(radius)), metres(turns), item.item, radius > 0.0, reader.speed)
    reader.actions.append(turn)
    return ""


def _return(reader: ItemReader, item: MissionItem) -> str:
    reader.actions.append(Return(item.item))
    return ""


def _land(reader: ItemReader, item: MissionItem) -> str:
    reader.actions.append(Land(_spot(item), item.item))
    return ""


def _speed(reader: ItemReader, item: MissionItem) -> str:
    speed = item.params[1]
    if speed is None or speed <= 0.0:
        return "it sets no speed" if speed in {None, -1.0} else f"a speed of {speed:g} m/s"
    reader.speed = metres(speed)
    return ""


def _delay(reader: ItemReader, item: MissionItem) -> str:
    seconds = item.params[0] or 0.0
    last = reader.actions[-1] if reader.actions else None
    if seconds <= 0.0 or not isinstance(last, Waypoint):
        return "it waits until a time of day, or nowhere"
    reader.actions[-1] = last._replace(wait=metres(last.wait + seconds))
    return ""


def _roi(reader: ItemReader, item: MissionItem) -> str:
    place = _place(reader, item)
    if item.command == mav.ROI_NONE or (item.command == mav.ROI and place == WITHOUT_PLACE):
        reader.look_at = None
        return ""
    if isinstance(place, str):
        return place
    reader.look_at = place
    return ""


def _photo(reader: ItemReader, item: MissionItem) -> str:
    last = reader.actions[-1] if reader.actions else None
    single = item.command == mav.DIGICAM or item.params[2] == 1.0
    if not single or not isinstance(last, Waypoint):
        return mav.REASONS[2001]
    reader.actions[-1] = last._replace(photo=True, wait=max(last.wait, PHOTO_TIME))
    note = "the camera is on while it waits"
    reader.ledger.approximate(item.item, note, PHOTO_TIME, "s")
    return ""


_READERS: Mapping[int, Callable[[ItemReader, MissionItem], str]] = {
    mav.WAYPOINT: _waypoint,
    mav.LOITER_TIME: _waypoint,
    mav.LOITER_TURNS: _turns,
    mav.RETURN: _return,
    mav.LAND: _land,
    mav.TAKE_OFF: _take_off,
    mav.DELAY: _delay,
    mav.CHANGE_SPEED: _speed,
    mav.ROI_LOCATION: _roi,
    mav.ROI_NONE: _roi,
    mav.ROI: _roi,
    mav.DIGICAM: _photo,
    mav.IMAGE_START: _photo,
}
