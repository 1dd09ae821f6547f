"""Complex items of QGroundControl: Survey, CorridorScan, StructureScan.

A survey and a corridor are flown by their parameters; the lines that the file may hold already are
what the result is compared with. A structure scan has none: it is flown as rounds of waypoints.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from missionkit.geodesy import Origin
from missionkit.interchange.bounded_input import number
from missionkit.interchange.fence_shapes import open_ring
from missionkit.interchange.lines import earth, local
from missionkit.interchange.mavlink_actions import ItemReader
from missionkit.interchange.mavlink_commands import WAYPOINT
from missionkit.interchange.plan import (
    Action,
    Corridor,
    LatLon,
    Place,
    Reference,
    Survey,
    Waypoint,
    degrees,
    metres,
)
from missionkit.interchange.qgc_values import section, spot, spots
from missionkit.polygons import unfit, widened

DISTANCE_MODES: Mapping[object, Reference] = {1: "above_home", 2: "amsl", 3: "agl", 4: "agl"}
MOST_LAYERS = 100
NO_AREA = "its polygon does not have three corners in latitude and longitude"
NO_SPACING = "it does not say how far apart its lines are (AdjustedFootprintSide)"
NO_HEIGHT = "it does not say how high it flies (DistanceToSurface)"


def read_complex(item: Mapping[str, Any], entry: int, reader: ItemReader) -> list[Action]:
    """Return what a complex item stands for, nothing if it is refused.

    Args:
        item: as JSON has it.
        entry: of the ledger.
        reader: of the mission, for the ledger and the speed.
    """
    kind = str(item.get("complexItemType"))[:40]
    if kind == "StructureScan":
        found: list[Action] | str = _structure(item, entry, reader)
    elif kind in {"survey", "CorridorScan"}:
        found = _transects(item, entry, reader)
    else:
        found = f"a mission has nothing like {kind}"
    if isinstance(found, str):
        reader.ledger.refuse(entry, found)
        return []
    return found


def _transects(item: Mapping[str, Any], entry: int, reader: ItemReader) -> list[Action] | str:
    style = section(item, "TransectStyleComplexItem")
    camera = section(style, "CameraCalc")
    spacing, height = number(camera.get("AdjustedFootprintSide")), _height(style, camera)
    if spacing is None or spacing <= 0.0:
        return NO_SPACING
    if height is None:
        return NO_HEIGHT
    turn = max(0.0, number(style.get("TurnAroundDistance")) or 0.0)
    shared = {
        "spacing": metres(spacing),
        "turn_around": metres(turn),
        "speed": reader.speed,
        "expanded": _expanded(style),
    }
    for key, note in (
        ("HoverAndCapture", "it does not stop for pictures"),
        ("CameraTriggerInTurnAround", ""),
    ):
        if style.get(key) is True and note:
            reader.ledger.approximate(entry, note)
    if item.get("complexItemType") == "CorridorScan":
        return _corridor(item, entry, height, shared)
    return _survey(item, entry, height, shared, crossed=style.get("Refly90Degrees") is True)


def _survey(
    item: Mapping[str, Any],
    entry: int,
    height: tuple[float, Reference],
    shared: Mapping[str, Any],
    *,
    crossed: bool,
) -> list[Action] | str:
    corners, angle = spots(item.get("polygon")), number(item.get("angle"))
    ring = open_ring(corners or ())
    if len(ring) < 3:
        return NO_AREA
    angles = [None] if angle is None else [angle, angle + 90.0] if crossed else [angle]
    return [
        Survey(ring, *height, entry, angle=None if it is None else metres(it % 180.0), **shared)
        for it in angles
    ]


def _corridor(
    item: Mapping[str, Any], entry: int, height: tuple[float, Reference], shared: Mapping[str, Any]
) -> list[Action] | str:
    line, breadth = spots(item.get("polyline")), number(item.get("CorridorWidth"))
    if line is None or len(line) < 2:
        return "its polyline does not have two places in latitude and longitude"
    if breadth is None or breadth <= 0.0:
        return "it has no width"
    return [Corridor(line, metres(breadth), *height, entry, **shared)]


def _height(style: Mapping[str, Any], camera: Mapping[str, Any]) -> tuple[float, Reference] | None:
    value = number(camera.get("DistanceToSurface"))
    if value is None:
        return None
    mode = camera.get("DistanceMode")
    relative: Reference = (
        "amsl" if camera.get("DistanceToSurfaceRelative") is False else "above_home"
    )
    reference = DISTANCE_MODES.get(mode, relative) if isinstance(mode, int) else relative
    return metres(value), "agl" if style.get("FollowTerrain") is True else reference


def _expanded(style: Mapping[str, Any]) -> tuple[LatLon, ...]:
    """Return the places of the lines that the file holds, if it does."""
    items = style.get("Items")
    rows = items if isinstance(items, list) else []
    flown = [it for it in rows if isinstance(it, dict) and it.get("command") == WAYPOINT]
    params = [it.get("params") for it in flown]
    places = [row[4:6] for row in params if isinstance(row, list)]
    found = tuple(it for it in map(spot, places) if it is not None)
    return found or spots(style.get("VisualTransectPoints")) or ()


def _structure(item: Mapping[str, Any], entry: int, reader: ItemReader) -> list[Action] | str:
    camera = section(item, "CameraCalc")
    away, tall = number(camera.get("DistanceToSurface")), number(item.get("StructureHeight"))
    layers = number(item.get("Layers"))
    bottom = number(item.get("ScanBottomAlt", item.get("Altitude", 0.0))) or 0.0
    if away is None or tall is None or layers is None:
        return "it lacks one of DistanceToSurface, StructureHeight, Layers"
    if away <= 0.0 or tall <= 0.0 or not 1 <= layers <= MOST_LAYERS:
        return f"expected distances above 0 m and 1 to {MOST_LAYERS} layers"
    ring = open_ring(spots(item.get("polygon")) or ())
    if len(ring) < 3:
        return NO_AREA
    step = tall / int(layers)
    heights = [bottom + (n + 0.5) * step for n in range(int(layers))]
    if item.get("StartFromTop") is True:
        heights.reverse()
    path = _around(ring, away)
    if path is None:
        return f"its polygon cannot be flown round at {away:g} m"
    reader.ledger.approximate(
        entry, "rounds of waypoints, the nose at the middle of the structure; no gimbal"
    )
    middle = LatLon(*(degrees(sum(axis) / len(ring)) for axis in zip(*ring, strict=True)))
    return [
        Waypoint(
            Place(*it, metres(height), "above_home"),
            entry,
            reader.speed,
            look_at=Place(*middle, metres(height), "above_home"),
        )
        for height in heights
        for it in (*path, path[0])
    ]


def _around(ring: tuple[LatLon, ...], away: float) -> tuple[LatLon, ...] | None:
    origin = Origin(*ring[0], 0.0)
    corners = local(ring, origin)
    wider = None if unfit(corners) else widened(corners, away)
    return None if wider is None else earth(wider, origin)
