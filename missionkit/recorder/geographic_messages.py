"""Messages of a flight record about the earth: origin, position, places, map."""

from __future__ import annotations

import base64
import datetime
import json
from collections.abc import Callable
from typing import NamedTuple, Self

import numpy as np

from missionkit.geodesy import Origin
from missionkit.geometry import from_euler, vec
from missionkit.messages import Estimate, Occupancy
from missionkit.recorder import json_fragments
from missionkit.recorder.scenery import Scenery, Spot

APPROXIMATED, UINT8 = 1, 1  # of foxglove.LocationFix and foxglove.PackedElementField
BLOCKED = 100  # as in ROS: 0 free, 100 blocked
ROOT = "world"


class Georeference(NamedTuple):
    """Where and when a flight takes place, as far as that is known."""

    origin: Callable[[], Origin | None]
    date: Callable[[], float]  # s since 1970

    @classmethod
    def fixed(cls, origin: Origin | None, date: Callable[[], float]) -> Self:
        """Return the reference of a flight whose origin is known beforehand, or never."""
        return cls(lambda: origin, date)


def origin(at: str, place: Origin, began: float) -> str:
    """Return where [0, 0, 0] is, and the date of mission time 0.

    Args:
        at: JSON of the time.
        place: of the world's origin.
        began: s since 1970.
    """
    utc = datetime.datetime.fromtimestamp(began, datetime.UTC).isoformat(timespec="milliseconds")
    return (
        f'{{"timestamp":{at},"latitude":{place.latitude},"longitude":{place.longitude},'
        f'"altitude":{place.altitude},"utc":"{utc.replace("+00:00", "Z")}"}}'
    )


def location(at: str, place: Origin, seen: Estimate) -> str:
    """Return the estimate as `foxglove.LocationFix`; the altitude is above mean sea level.

    Args:
        at: JSON of the time.
        place: of the world's origin.
        seen: the estimate.
    """
    latitude, longitude, altitude = place.place(seen.position)
    variance = min(float(seen.health.position_sd) ** 2, 1e12)
    covariance = [variance if n % 4 == 0 else 0.0 for n in range(9)]
    return (
        f'{{"timestamp":{at},"frame_id":"{ROOT}","latitude":{latitude},"longitude":{longitude},'
        f'"altitude":{altitude},"position_covariance":{covariance},'
        f'"position_covariance_type":{APPROXIMATED}}}'
    )


def places(place: Origin, scenery: Scenery) -> str:
    """Return targets and fences as `foxglove.GeoJSON`."""

    def at(spot: Spot) -> list[float]:
        latitude, longitude, _ = place.place(vec(*spot, 0.0))
        return [round(longitude, 9), round(latitude, 9)]

    def ring(corners: tuple[Spot, ...]) -> list[list[float]]:
        return [at(corner) for corner in (*corners, corners[0])]

    features = [_feature(it.name, "Point", at(it.at)) for it in scenery.targets]
    features += [
        _feature("fence", "Polygon", [ring(shape) for shape in (it.corners, *it.holes)])
        for it in scenery.fences
    ]
    written = json.dumps({"type": "FeatureCollection", "features": features})
    return json.dumps({"geojson": written})


def grid(at: str, known: Occupancy) -> str:
    """Return the map as `foxglove.Grid`: `occupancy` from 0, free, to 100, blocked.

    Between them is ground where a metre costs c: 100 (1 - 1/c), at most 99.
    """
    rows, columns = known.costs.shape
    free = np.isfinite(known.costs)
    shades = np.full((rows, columns), BLOCKED, np.uint8)
    shades[free] = np.minimum(BLOCKED - 1, np.round(BLOCKED * (1.0 - 1.0 / known.costs[free])))
    north, east = known.origin
    pose = json_fragments.pose(vec(east, north, 0.0), from_euler(0.0, 0.0, known.turned))
    data = base64.b64encode(shades.tobytes()).decode("ascii")
    return (
        f'{{"timestamp":{at},"frame_id":"{ROOT}","pose":{pose},"column_count":{columns},'
        f'"cell_size":{{"x":{known.resolution},"y":{known.resolution}}},"row_stride":{columns},'
        f'"cell_stride":1,"fields":[{{"name":"occupancy","offset":0,"type":{UINT8}}}],'
        f'"data":"{data}"}}'
    )


def _feature(name: str, kind: str, coordinates: object) -> dict[str, object]:
    geometry = {"type": kind, "coordinates": coordinates}
    return {"type": "Feature", "properties": {"name": name}, "geometry": geometry}
