"""Where the mission's world begins: home, held fast for the whole flight.

North and east are measured along the ellipsoid's radii of curvature at home (WGS 84), which within
2 km of it is right to 0.1 per mille. Simulators of autopilots lay their world on a sphere instead.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from missionkit.geometry import Vec3, vec

_A = 6378137.0  # m, semi-major axis
_E2 = 6.69437999014e-3  # eccentricity squared


class Origin(NamedTuple):
    """A place on the earth."""

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
        meridian, normal = self._radii()
        north = math.radians(latitude - self.latitude) * meridian
        around = math.remainder(longitude - self.longitude, 360.0)
        east = math.radians(around) * normal * math.cos(math.radians(self.latitude))
        return vec(north, east, self.altitude - altitude)

    def place(self, local: Vec3) -> tuple[float, float, float]:
        """Return latitude, longitude (deg, to ±180) and altitude (m) of a point (3,), m, NED."""
        meridian, normal = self._radii()
        flat = normal * math.cos(math.radians(self.latitude))
        return (
            self.latitude + math.degrees(float(local[0]) / meridian),
            math.remainder(self.longitude + math.degrees(float(local[1]) / flat), 360.0),
            self.altitude - float(local[2]),
        )

    def _radii(self) -> tuple[float, float]:
        if self.sphere is not None:
            return self.sphere, self.sphere
        squared = 1.0 - _E2 * math.sin(math.radians(self.latitude)) ** 2
        return _A * (1.0 - _E2) / squared**1.5, _A / math.sqrt(squared)
