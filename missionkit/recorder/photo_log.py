"""Where photos were taken from: a row each in `photos.csv`."""

from __future__ import annotations

import datetime
import math
from pathlib import Path

from missionkit.geodesy import Origin
from missionkit.geometry import to_euler
from missionkit.messages import Device, Record

HEADER = (
    "photo,time_s,utc,latitude_deg,longitude_deg,altitude_m,north_m,east_m,down_m,"
    "roll_deg,pitch_deg,yaw_deg,position_sd_m\n"
)


def rows(record: Record, origin: Origin | None, began: float | None, before: int) -> list[str]:
    """Return a row of text for each photo of a tick, by the estimate; empty: not known.

    Args:
        record: of the tick.
        origin: of the world, if it is known.
        began: s since 1970, at mission time 0, if it is known.
        before: photos of the flight so far.
    """
    taken = sum(order.device is Device.CAMERA for order in record.command.orders)
    return [_row(record, origin, began, before + n + 1) for n in range(taken)]


def _row(record: Record, origin: Origin | None, began: float | None, number: int) -> str:
    seen = record.estimate
    place = seen.position.tolist()
    angles = [math.degrees(angle) for angle in to_euler(seen.attitude)]
    earth = ["", "", ""]
    if origin is not None:
        latitude, longitude, altitude = origin.place(seen.position)
        earth = [f"{latitude:.8f}", f"{longitude:.8f}", f"{altitude:.2f}"]
    utc = ""
    if began is not None:
        date = datetime.datetime.fromtimestamp(began + record.now, datetime.UTC)
        utc = date.isoformat(timespec="milliseconds").replace("+00:00", "Z")
    numbers = [f"{it:.3f}" for it in place] + [f"{it:.2f}" for it in angles]
    cells = [str(number), f"{record.now:.3f}", utc, *earth, *numbers]
    return ",".join([*cells, f"{seen.health.position_sd:.2f}"]) + "\n"


def append(path: Path, text: list[str]) -> None:
    """Write rows at the end of a log, its header first."""
    new = not path.exists()
    torn = not new and not path.read_bytes().endswith(b"\n")  # killed while it wrote
    with path.open("a", encoding="utf-8") as file:
        file.writelines([HEADER, *text] if new else ["\n" * torn, *text])


def last_number(path: Path) -> int:
    """Return the number of the last photo of a log that is continued, 0 if there is none."""
    if not path.exists():
        return 0
    cells = (line.split(",", 1)[0] for line in path.read_text("utf-8", "replace").splitlines())
    return max((int(it) for it in cells if it.isdecimal()), default=0)
