"""Between the world's NED metres and latitude, longitude and height, as autopilots convert.

Source: PX4 `src/lib/geo/geo.h` (CONSTANTS_RADIUS_OF_EARTH 6371000 m); ArduPilot
`libraries/AP_Common/Location.h` (LOCATION_SCALING_FACTOR 0.011131884502145034 m per 1e-7 deg).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from missionkit.geometry import Vec3, vec

PX4_RADIUS = 6_371_000.0  # m
ARDUPILOT_RADIUS = 0.011131884502145034 * 1e7 * 180.0 / math.pi  # m
ZURICH = (47.397742, 8.545594, 488.0)  # deg, deg, m: where PX4's simulations begin


class GeographicPoint(NamedTuple):
    """A place on the Earth."""

    latitude: float  # deg
    longitude: float  # deg
    height: float  # m above mean sea level


class Earth(NamedTuple):
    """A sphere around the origin of the world, flat near it."""

    origin: GeographicPoint
    radius: float = PX4_RADIUS  # m

    def spot(self, position: Vec3) -> GeographicPoint:
        """Return where `position` (3,), m, NED, is."""
        here, shrink = self.origin, math.cos(math.radians(self.origin.latitude))
        return GeographicPoint(
            here.latitude + math.degrees(float(position[0]) / self.radius),
            math.remainder(
                here.longitude + math.degrees(float(position[1]) / (self.radius * shrink)), 360.0
            ),
            here.height - float(position[2]),
        )

    def position(self, spot: GeographicPoint) -> Vec3:
        """Return (3,), m, NED, of a place near the origin."""
        here, shrink = self.origin, math.cos(math.radians(self.origin.latitude))
        return vec(
            math.radians(spot.latitude - here.latitude) * self.radius,
            math.radians(math.remainder(spot.longitude - here.longitude, 360.0))
            * self.radius
            * shrink,
            here.height - spot.height,
        )


def e7(degrees: float) -> int:
    """Return degrees as MAVLink counts them."""
    return round(degrees * 1e7)
