"""Plans of QGroundControl (.plan): items, surveys, fence and rally points.

https://docs.qgroundcontrol.com/master/en/qgc-dev-guide/file_formats/plan.html
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

from missionkit.interchange import mavlink_commands as mav
from missionkit.interchange.bounded_input import number, padded
from missionkit.interchange.fence_shapes import FenceShapes
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.mavlink_actions import AFTER_LANDING, ItemReader
from missionkit.interchange.mavlink_commands import MissionItem
from missionkit.interchange.plan import Home, Place, Plan, Rally, metres
from missionkit.interchange.qgc_complex_items import read_complex
from missionkit.interchange.qgc_values import listed, section, spot, spots

ARDUPILOT = 3  # MAV_AUTOPILOT


def read_plan(data: Any, ledger: Ledger) -> Plan:
    """Return the plan in a document of QGroundControl.

    Args:
        data: as JSON has it; NaN is None.
        ledger: gets one entry for each item, fence and rally point.

    Raises:
        ForeignFileError: it is no plan.
    """
    mission = section(data, "mission")
    home = _home(mission.get("plannedHomePosition"), ledger)
    reader = ItemReader(ledger, zero_yaw_is_free=mission.get("firmwareType") == ARDUPILOT)
    for count, item in enumerate(listed(mission, "items"), 1):
        _item(reader, item, count)
    shapes = FenceShapes()
    _fence(section(data, "geoFence"), shapes, ledger)
    rally = tuple(_rally(section(data, "rallyPoints"), ledger))
    return Plan(home, tuple(reader.actions), shapes.fence(ledger), rally)


def _home(row: object, ledger: Ledger) -> Home | None:
    """Return the home of the plan; None: it has none, or one that the ledger refuses."""
    if row is None:
        return None
    found = spot(row)
    alt = number(row[2]) if isinstance(row, list) and len(row) > 2 else None
    if found is not None and alt is not None and found != (0.0, 0.0):
        return Home(*found, metres(alt))
    entry = ledger.open("plannedHomePosition", "home")
    given = json.dumps(row)[:40]
    ledger.refuse(entry, f"{given} is not [latitude, longitude, altitude] of a place on the earth")
    return None


def _item(reader: ItemReader, item: object, count: int) -> None:
    kind = item.get("type") if isinstance(item, dict) else None
    label = f"item {count}"
    if kind == "ComplexItem" and isinstance(item, dict):
        entry = reader.ledger.open(label, str(item.get("complexItemType"))[:40])
        if reader.landed:
            reader.ledger.refuse(entry, AFTER_LANDING)
            return
        reader.actions += read_complex(item, entry, reader)
        return
    command = item.get("command") if isinstance(item, dict) else None
    if kind != "SimpleItem" or not isinstance(item, dict) or not isinstance(command, int):
        entry = reader.ledger.open(label, str(kind)[:40])
        reader.ledger.refuse(entry, "neither a SimpleItem with a command nor a ComplexItem")
        return
    entry = reader.ledger.open(label, mav.name_of(command))
    reader.take(_simple(item, command, entry))


def _simple(item: Mapping[str, Any], command: int, entry: int) -> MissionItem:
    """Return an item; version 1 of the format has `coordinate` and four parameters by name."""
    params = item.get("params")
    if isinstance(params, list):
        values = [number(it) for it in params]
    else:
        place = item.get("coordinate")
        place = place if isinstance(place, list) else []
        values = [number(item.get(f"param{n}")) for n in range(1, 5)] + [number(it) for it in place]
    a, b, c, d, e, f, g = padded(values, 7)
    frame = item.get("frame")
    return MissionItem(
        command,
        frame if isinstance(frame, int) else -1,
        (a, b, c, d, e, f, g),
        entry,
        proceeds=item.get("autoContinue") is not False,
        amsl=number(item.get("AMSLAltAboveTerrain")),
    )


def _fence(given: Mapping[str, Any], shapes: FenceShapes, ledger: Ledger) -> None:
    for count, shape in enumerate(listed(given, "polygons"), 1):
        inward = not isinstance(shape, dict) or shape.get("inclusion") is not False
        what = f"{'inclusion' if inward else 'exclusion'} polygon"
        entry = ledger.open(f"fence polygon {count}", what)
        corners = spots(shape.get("polygon")) if isinstance(shape, dict) else None
        shapes.polygon(corners, entry, ledger, inward=inward)
    for count, shape in enumerate(listed(given, "circles"), 1):
        inward = not isinstance(shape, dict) or shape.get("inclusion") is not False
        what = f"{'inclusion' if inward else 'exclusion'} circle"
        entry = ledger.open(f"fence circle {count}", what)
        circle = shape.get("circle") if isinstance(shape, dict) else None
        circle = circle if isinstance(circle, dict) else {}
        shapes.circle(
            spot(circle.get("center")),
            number(circle.get("radius")),
            entry,
            ledger,
            inward=inward,
        )
    if given.get("breachReturn") is not None:
        entry = ledger.open("fence", "breach return point")
        ledger.refuse(entry, "a failsafe of a mission leads to a state: it flies home")


def _rally(given: Mapping[str, Any], ledger: Ledger) -> Iterable[Rally]:
    for count, row in enumerate(listed(given, "points"), 1):
        entry = ledger.open(f"rally point {count}", "rally point")
        place = spot(row)
        height = number(row[2]) if isinstance(row, list) and len(row) > 2 else None
        if place is None or height is None:
            ledger.refuse(entry, "expected [lat, lon, height]")
            continue
        ledger.remark(entry, "kept as a target; failsafes fly home")
        yield Rally(Place(*place, metres(height), "above_home"), entry)
