"""Between latitude, longitude and altitude on the WGS 84 ellipsoid and a world in metres, NED.

North and east are those of the tangent plane at the origin, at the origin's altitude, so that a
place lies above its coordinates however high it is. Down is the difference in altitude, as
barometers and autopilots measure it: two places of one altitude are level, however far apart. (In
the tangent plane the farther one would lie lower, by 8 cm at 1 km.)

The geoid is taken as parallel to the ellipsoid around the origin: 50 m between them change north
and east by 8 mm in 1 km.

Source: `pymap3d` (geodetic to ECEF to NED); imported here alone, and late.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from missionkit.geometry import Vec3, vec

_CLOSE = 1e-6  # m
_ROUNDS = 8
_TYPICAL_RADIUS = 6_371_000.0  # m


class Origin(NamedTuple):
    """Where the origin of a world in metres lies on the earth."""

    latitude: float  # deg
    longitude: float  # deg
    altitude: float  # m above mean sea level
    sphere: float | None = None  # m, radius of the earth that a simulator believes in

    def local(self, latitude: float, longitude: float, altitude: float) -> Vec3:
        """Return a place as (3,), m, NED.

        Args:
            latitude: deg, WGS 84.
            longitude: deg, WGS 84; across the date line too.
            altitude: m, above the same level as the origin's.
        """
        north, east = self._level(latitude, longitude)
        return vec(north, east, self.altitude - altitude)

    def place(self, local: Vec3) -> tuple[float, float, float]:
        """Return latitude, longitude (deg, to ±180) and altitude (m) of a point (3,), m, NED."""
        north, east, down = (float(part) for part in local)
        latitude, longitude = self._geodetic(north, east)
        return latitude, math.remainder(longitude, 360.0), self.altitude - down

    def distance(self, latitude: float, longitude: float) -> float:
        """Return how far away a place is (m), along the earth, to about 0.5 %.

        The haversine formula.
        """
        lat, other = math.radians(self.latitude), math.radians(latitude)
        across = math.radians(longitude - self.longitude)
        half = math.sin((other - lat) / 2.0) ** 2
        half += math.cos(lat) * math.cos(other) * math.sin(across / 2.0) ** 2
        return 2.0 * _TYPICAL_RADIUS * math.asin(math.sqrt(min(1.0, half)))

    def _level(self, latitude: float, longitude: float) -> tuple[float, float]:
        if self.sphere is not None:
            shrink = math.cos(math.radians(self.latitude))
            around = math.remainder(longitude - self.longitude, 360.0)
            return (
                math.radians(latitude - self.latitude) * self.sphere,
                math.radians(around) * self.sphere * shrink,
            )
        from pymap3d.ned import geodetic2ned  # noqa: PLC0415 slow to import

        here = self.latitude, self.longitude, self.altitude
        north, east, _ = geodetic2ned(latitude, longitude, self.altitude, *here)
        return float(north), float(east)

    def _geodetic(self, north: float, east: float) -> tuple[float, float]:
        if self.sphere is not None:
            shrunk = self.sphere * math.cos(math.radians(self.latitude))
            return (
                self.latitude + math.degrees(north / self.sphere),
                self.longitude + math.degrees(east / shrunk),
            )
        from pymap3d.ned import ned2geodetic  # noqa: PLC0415 slow to import

        here = self.latitude, self.longitude, self.altitude
        down = (north * north + east * east) / (2.0 * _TYPICAL_RADIUS)  # of the tangent plane
        latitude, longitude, altitude = ned2geodetic(north, east, down, *here)
        for _ in range(_ROUNDS):
            off = float(altitude) - self.altitude
            if abs(off) < _CLOSE:
                break
            down += off
            latitude, longitude, altitude = ned2geodetic(north, east, down, *here)
        return float(latitude), float(longitude)
