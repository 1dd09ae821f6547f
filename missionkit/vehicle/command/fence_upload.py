"""The autopilot's own geofence and rally points, uploaded and read back.

The last line of defence: it holds when companion and link are gone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from missionkit.errors import VehicleError
from missionkit.geodesy import Origin
from missionkit.geometry import vec
from missionkit.vehicle.link.connection import Link
from missionkit.vehicle.link.message_link import PlanItem

INCLUSION = 5001  # MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION
EXCLUSION = 5002  # MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION
EXCLUSION_CIRCLE = 5004  # MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION
RALLY_POINT = 5100  # MAV_CMD_NAV_RALLY_POINT
FENCE_PLAN, RALLY_PLAN = 1, 2  # MAV_MISSION_TYPE
READINGS = 3
FRAME_GLOBAL, FRAME_RELATIVE = 0, 3  # MAV_FRAME
Ground = tuple[float, float]  # north, east, m

_COMPARED_FIELDS = ("command", "x", "y", "mission_type")


def polygon(
    origin: Origin, corners: Sequence[Ground], holes: Sequence[Sequence[Ground]] = ()
) -> tuple[PlanItem, ...]:
    """Return the items of a fence to stay inside of, and of holes in it to stay out of.

    Args:
        origin: of the mission's world.
        corners: m, at least three.
        holes: corners of each, m.
    """
    items: list[PlanItem] = []
    for command, shape in ((INCLUSION, corners), *((EXCLUSION, hole) for hole in holes)):
        count = len(shape)
        if count < 3:
            raise VehicleError("a fence needs at least three corners")
        for corner in shape:
            x, y = _place(origin, corner)
            rest = 0.0, FENCE_PLAN, FRAME_GLOBAL
            items.append(PlanItem(len(items), command, x, y, *rest, param1=float(count)))
    return tuple(items)


def rally(origin: Origin, points: Sequence[tuple[float, float, float]]) -> tuple[PlanItem, ...]:
    """Return rally points (north, east, height above home, m)."""
    items = []
    for seq, (north, east, height) in enumerate(points):
        x, y = _place(origin, (north, east))
        items.append(PlanItem(seq, RALLY_POINT, x, y, height, RALLY_PLAN, FRAME_RELATIVE))
    return tuple(items)


def set_fence(link: Link, items: Sequence[PlanItem]) -> None:
    """Upload a fence and make sure that the autopilot has it. Blocks the calling thread.

    Raises:
        VehicleError: it does not.
    """
    link.upload_fence(items)
    _confirm("the geofence", items, link.download_fence)


def set_rally(link: Link, items: Sequence[PlanItem]) -> None:
    """Upload rally points and make sure that the autopilot has them. Blocks the calling thread.

    Raises:
        VehicleError: it does not.
    """
    link.upload_rally(items)
    _confirm("the rally points", items, link.download_rally)


def _place(origin: Origin, ground: Ground) -> tuple[int, int]:
    latitude, longitude, _ = origin.place(vec(*ground, 0.0))
    return round(1e7 * latitude), round(1e7 * longitude)


def _confirm(what: str, sent: Sequence[PlanItem], read: Callable[[], Sequence[PlanItem]]) -> None:
    """Read back until it is what was sent: an answer may be lost, or an older one come late."""
    got: Sequence[PlanItem] = ()
    for _ in range(READINGS):
        got = read()
        if _same(sent, got):
            return
    raise VehicleError(
        f"{what} was sent with {len(sent)} points, but the autopilot has {len(got)}, "
        "or different ones: do not rely on it"
    )


def _same(sent: Sequence[PlanItem], got: Sequence[PlanItem]) -> bool:
    return len(sent) == len(got) and all(
        all(getattr(a, name) == getattr(b, name) for name in _COMPARED_FIELDS)
        and abs(a.z - b.z) <= 0.01
        and abs(a.param1 - b.param1) <= 0.01
        for a, b in zip(sent, got, strict=True)
    )
