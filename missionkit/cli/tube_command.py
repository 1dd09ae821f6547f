"""`missionkit export CAMPAIGN -o tube.kml`: where the flights of a campaign were."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from missionkit.cli.interchange_output import home_of, write
from missionkit.errors import ExitCode, UsageError, printable
from missionkit.geodesy import Origin
from missionkit.interchange.flown_tube import Points, by_visit
from missionkit.interchange.tube_kml import LEVELS, tube_kml
from missionkit.recorder.record_reader import read

RECORDS = "records"
POSES = ("/truth/pose", "/pose")  # the first that a record has


def export_tube(folder: Path, out: Path, home: str | None, *, force: bool) -> ExitCode:
    """Write the quantiles of where the flights of a campaign were, as volumes.

    Args:
        folder: of a campaign flown with `--records`.
        out: file to write.
        home: LAT,LON,ALT of a mission without an origin.
        force: replace a file that exists.

    Raises:
        UsageError: there are no records, or it is not known where they are on the earth.
    """
    if out.suffix.lower() != ".kml":
        raise UsageError(f"{out}: the tube of a campaign is written as .kml")
    if out.exists() and not force:
        raise UsageError(f"{out}: it exists already; --force replaces it")
    files = sorted((folder / RECORDS).glob("*/flight.mcap"), key=lambda it: it.parent.name)
    if not files:
        raise UsageError(f"{folder}: no flight records; fly the campaign with --records")
    paths = by_visit(list(_flight(it)) for it in files)
    if not paths:
        raise UsageError(f"{folder}: no state that two flights flew through")
    given = home_of(home)
    origin = _origin(files[0]) if given is None else Origin(*given)
    if origin is None:
        raise UsageError(f"{folder}: its mission has no origin: --home LAT,LON,ALT says where")
    write(out, tube_kml(paths, origin, folder.name), force=force)
    shares = ", ".join(f"{level.share:.0%}" for level in LEVELS)
    print(printable(f"{out}: {len(files)} flights, {len(paths)} states; {shares} of them"))  # noqa: T201
    return ExitCode.SUCCESS


def _flight(path: Path) -> Iterator[tuple[str, Points]]:
    """Yield the states of a flight with the path in each, m, NED."""
    rows = list(read(path, "/state", *POSES))
    wanted = next((it for it in POSES if any(row.topic == it for row in rows)), "")
    state, places = "", list[tuple[float, float, float]]()
    for row in rows:
        if row.topic == "/state" and row.data["state"] != state:
            if state:
                yield state, np.array(places).reshape(-1, 3)
            state, places = str(row.data["state"]), places[-1:]
        elif row.topic == wanted:
            at = row.data["pose"]["position"]
            places.append((at["x"], at["y"], at["z"]))
    if state:
        yield state, np.array(places).reshape(-1, 3)


def _origin(path: Path) -> Origin | None:
    for row in read(path, "/origin"):
        return Origin(row.data["latitude"], row.data["longitude"], row.data["altitude"])
    return None
