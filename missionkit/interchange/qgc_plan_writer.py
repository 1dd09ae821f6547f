"""Plans written as QGroundControl reads them (.plan)."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from itertools import count
from typing import Any

from missionkit.geodesy import Origin
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.lines import local
from missionkit.interchange.mavlink_commands import MISSION_FRAME, MissionItem
from missionkit.interchange.mavlink_items import ItemWriter
from missionkit.interchange.plan import Corridor, Fence, Home, LatLon, Plan, Survey, metres
from missionkit.planning.survey_pattern import best_heading

GENERIC, COPTER = 12, 2  # MAV_AUTOPILOT_PX4, MAV_TYPE_QUADROTOR: what the editor expects
_MODES = {0: 2, 3: 1, 10: 4}  # AltitudeMode of a frame


def plan_json(plan: Plan, ledger: Ledger) -> str:
    """Return a plan of QGroundControl.

    Args:
        plan: with home.
        ledger: where what it cannot say is noted.
    """
    home = plan.home or Home(0.0, 0.0, 0.0)
    writer = ItemWriter(plan, Origin(*home), ledger)
    numbers = count(1)
    items: list[dict[str, Any]] = []
    for action in plan.actions:
        if isinstance(action, Survey | Corridor):
            items += [_simple(it, next(numbers)) for it in writer.set_speed(action.speed)]
            items.append(_complex(action, writer, numbers))
        else:
            items += [_simple(it, next(numbers)) for it in writer.items(action)]
    whole = plan_document(items, home, _polygons(plan.fence), _rally(plan))
    if plan.fence is not None and plan.fence.item >= 0 and plan.fence.height is not None:
        note = f"its ceiling of {plan.fence.height:g} m is a parameter of the autopilot"
        ledger.approximate(plan.fence.item, note)
    return json.dumps(whole, indent=2) + "\n"


def plan_document(
    items: Sequence[dict[str, Any]],
    home: Home,
    polygons: Sequence[tuple[Sequence[LatLon], bool]],
    rally: Sequence[Sequence[float]],
) -> dict[str, Any]:
    """Return the document of a plan.

    Args:
        items: of the mission, as QGroundControl writes them.
        home: where it takes off.
        polygons: of the fence: corners, and whether to stay inside of them.
        rally: latitude, longitude, height above home of each point.
    """
    return {
        "fileType": "Plan",
        "groundStation": "missionkit",
        "version": 1,
        "mission": {
            "version": 2,
            "firmwareType": GENERIC,
            "vehicleType": COPTER,
            "cruiseSpeed": 15,
            "hoverSpeed": 5,
            "items": list(items),
            "plannedHomePosition": list(home),
        },
        "geoFence": {
            "version": 2,
            "circles": [],
            "polygons": [
                {"version": 1, "inclusion": inclusion, "polygon": [list(it) for it in corners]}
                for corners, inclusion in polygons
            ],
        },
        "rallyPoints": {"version": 2, "points": [list(it) for it in rally]},
    }


def _polygons(fence: Fence | None) -> list[tuple[Sequence[LatLon], bool]]:
    if fence is None:
        return []
    return [(fence.outline, True), *((corners, False) for corners, _ in fence.holes)]


def _rally(plan: Plan) -> list[Sequence[float]]:
    """Return the rally points; a height above sea level is given above home."""
    rows: list[Sequence[float]] = []
    for place in (it.place for it in plan.rally):
        above = plan.home.alt if plan.home and place.reference == "amsl" else 0.0
        rows.append((*place.spot, metres(place.height - above)))
    return rows


def _simple(item: MissionItem, number: int) -> dict[str, Any]:
    found: dict[str, Any] = {
        "type": "SimpleItem",
        "command": item.command,
        "frame": item.frame,
        "autoContinue": True,
        "doJumpId": number,
        "params": list(item.params),
    }
    if item.frame != MISSION_FRAME:
        found |= {
            "AltitudeMode": _MODES[item.frame],
            "Altitude": item.params[6],
            "AMSLAltAboveTerrain": None,
        }
    return found


def _complex(
    action: Survey | Corridor, writer: ItemWriter, numbers: Iterator[int]
) -> dict[str, Any]:
    """Return a survey or a corridor with its lines."""
    lines = [_simple(it, next(numbers)) for it in writer.lines(action)]
    style = {
        "version": 1,
        "CameraCalc": {
            "version": 1,
            "CameraName": "Manual (no camera specs)",
            "AdjustedFootprintFrontal": action.spacing,
            "AdjustedFootprintSide": action.spacing,
            "DistanceToSurface": action.height,
            "DistanceToSurfaceRelative": True,
        },
        "CameraShots": 0,
        "CameraTriggerInTurnAround": False,
        "FollowTerrain": False,
        "HoverAndCapture": False,
        "Items": lines,
        "Refly90Degrees": False,
        "TurnAroundDistance": action.turn_around,
        "VisualTransectPoints": [it["params"][4:6] for it in lines],
    }
    shared = {"type": "ComplexItem", "TransectStyleComplexItem": style}
    if isinstance(action, Corridor):
        return shared | {
            "complexItemType": "CorridorScan",
            "version": 2,
            "CorridorWidth": action.breadth,
            "EntryPoint": 0,
            "polyline": [list(it) for it in action.line],
        }
    area, angle = local(action.polygon, writer.origin), action.angle
    if angle is None:
        angle = metres(math.degrees(best_heading(area, action.spacing or 1.0)))
    return shared | {
        "complexItemType": "survey",
        "version": 5,
        "angle": angle,
        "entryLocation": 0,
        "flyAlternateTransects": False,
        "splitConcavePolygons": False,
        "polygon": [list(it) for it in action.polygon],
    }
