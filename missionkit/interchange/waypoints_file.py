"""The text files of waypoints that most ground stations write (QGC WPL 110).

One item a line: number, current, frame, command, four parameters, latitude, longitude, altitude,
autocontinue. The first is home. https://mavlink.io/en/file_formats/
"""

from __future__ import annotations

from missionkit.geodesy import Origin
from missionkit.interchange import mavlink_commands as mav
from missionkit.interchange.bounded_input import ForeignFileError, number
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.mavlink_actions import ItemReader
from missionkit.interchange.mavlink_commands import MissionItem
from missionkit.interchange.mavlink_items import ItemWriter, refuse_shapes
from missionkit.interchange.mission_text import figure
from missionkit.interchange.plan import Corridor, Home, Plan, Survey, degrees, metres

HEADER = "QGC WPL 110"
COLUMNS = 12
EXPANDED = "the places of its lines, no longer a survey"


def read_waypoints(text: str, ledger: Ledger) -> Plan:
    """Return the plan in a file of waypoints.

    Args:
        text: of the file.
        ledger: gets an entry for each line.

    Raises:
        ForeignFileError: it is of another version.
    """
    header, *rows = text.splitlines()
    if header.split() != HEADER.split():
        raise ForeignFileError(f"it begins with {header[:40]!r}, expected {HEADER!r}")
    reader = ItemReader(ledger, zero_yaw_is_free=True)
    home: Home | None = None
    for line, row in enumerate(rows, 2):
        if not row.strip() or row.lstrip().startswith("#"):
            continue
        values = [number(it) for it in row.split()]
        entry = ledger.open(f"line {line}", "line")
        item = _item(values, entry)
        if item is None:
            ledger.refuse(entry, f"expected {COLUMNS} columns of numbers, got {len(values)}")
            continue
        first = len(ledger.entries) == 1 and item.command == mav.WAYPOINT and item.frame == 0
        what = "home" if first else mav.name_of(item.command)
        ledger.entries[entry] = ledger.entries[entry]._replace(what=what)
        if first:
            home = _home(item, ledger)
        else:
            reader.take(item)
    return Plan(home, tuple(reader.actions))


def waypoints_text(plan: Plan, ledger: Ledger) -> str:
    """Return a plan as a file of waypoints; surveys as the places of their lines.

    Args:
        plan: with home.
        ledger: where what it cannot say is noted.
    """
    home = plan.home or Home(0.0, 0.0, 0.0)
    writer = ItemWriter(plan, Origin(*home), ledger)
    refuse_shapes(plan, ledger, "a file of waypoints")
    lines = [HEADER, _row(0, MissionItem(mav.WAYPOINT, 0, (0.0, 0.0, 0.0, None, *home)))]
    for action in plan.actions:
        if isinstance(action, Survey | Corridor):
            ledger.approximate(action.item, EXPANDED, 0.0)
        for item in writer.items(action):
            lines.append(_row(len(lines) - 1, item))
    return "\n".join([*lines, ""])


def _item(values: list[float | None], entry: int) -> MissionItem | None:
    if len(values) != COLUMNS or values[2] is None or values[3] is None:
        return None
    a, b, c, d, lat, lon, alt = values[4:11]
    return MissionItem(
        int(values[3]),
        int(values[2]),
        (a, b, c, d, lat, lon, alt),
        entry,
        proceeds=values[11] != 0.0,
    )


def _home(item: MissionItem, ledger: Ledger) -> Home | None:
    lat, lon, alt = item.params[4:]
    if lat is None or lon is None or alt is None or (lat == 0.0 and lon == 0.0):
        ledger.refuse(item.item, "home is not set")
        return None
    if abs(lat) > 90.0 or abs(lon) > 180.0:
        ledger.refuse(item.item, f"{lat:g}, {lon:g} is not a place on the earth")
        return None
    return Home(degrees(lat), degrees(lon), metres(alt))


def _row(count: int, item: MissionItem) -> str:
    """Return a line; a heading of north is 360, since 0 stands for none."""
    params = list(item.params)
    if params[3] == 0.0 and item.command == mav.WAYPOINT and count:
        params[3] = 360.0
    numbers = [count, int(count == 0), item.frame, item.command]
    return "\t".join([*map(str, numbers), *(figure(it or 0.0) for it in params), "1"])
