"""Conversion between degrees and metres, against geographiclib and closed-form ECEF."""

from __future__ import annotations

import math

import numpy as np
import pytest
from geographiclib.geodesic import Geodesic

from missionkit.geodesy import Origin
from missionkit.geometry import vec

ORIGINS = {
    "zurich": Origin(47.397742, 8.545594, 488.0),
    "date line": Origin(-17.0, 179.99, 3.0),
    "date line from the west": Origin(-17.0, -179.999, 3.0),
    "80 north": Origin(80.0, 15.0, 20.0),
    "dead sea": Origin(31.5, 35.48, -430.0),
    "equator": Origin(0.0, 0.0, 0.0),
    "la paz": Origin(-16.51, -68.19, 4061.0),
    "south pole": Origin(-89.99, 100.0, 2835.0),
}
A, F = 6378137.0, 1.0 / 298.257223563
E2 = F * (2.0 - F)


@pytest.mark.parametrize("origin", ORIGINS.values(), ids=ORIGINS)
@pytest.mark.parametrize("distance", [10.0, 1_000.0, 5_000.0])
@pytest.mark.parametrize("azimuth", [0.0, 37.0, 90.0, 200.0, 275.0])
def test_a_geodesic_at_the_origins_altitude(origin, distance, azimuth):
    """geographiclib measures on the ellipsoid; at an altitude h lengths grow with the radius."""
    line = Geodesic.WGS84.Direct(origin.latitude, origin.longitude, azimuth, distance)
    north, east, down = origin.local(line["lat2"], line["lon2"], origin.altitude + 12.0)
    radius = _radius(origin.latitude, azimuth)
    grown = radius * math.sin(distance / radius) * (1.0 + origin.altitude / radius)
    assert math.hypot(north, east) == pytest.approx(grown, abs=2e-3)
    heading = math.degrees(math.atan2(east, north))
    off = math.radians(math.remainder(heading - azimuth, 360.0)) * distance
    assert abs(off) < 1e-2
    assert down == -12.0


@pytest.mark.parametrize("origin", ORIGINS.values(), ids=ORIGINS)
def test_north_and_east_in_closed_form(origin):
    for step in ((1e-3, 2e-3), (-5e-3, 1e-3), (2e-3, -8e-3)):
        latitude = max(-90.0, origin.latitude + step[0])
        longitude = math.remainder(origin.longitude + step[1], 360.0)
        found = origin.local(latitude, longitude, origin.altitude)
        assert found[:2] == pytest.approx(_tangent(origin, latitude, longitude), abs=1e-6)


@pytest.mark.parametrize("origin", ORIGINS.values(), ids=ORIGINS)
def test_there_and_back(origin):
    for point in ((0.0, 0.0, 0.0), (120.0, -80.0, -30.0), (-4_000.0, 2_500.0, 15.0)):
        latitude, longitude, altitude = origin.place(vec(*point))
        assert -180.0 <= longitude <= 180.0
        assert origin.local(latitude, longitude, altitude) == pytest.approx(point, abs=1e-5)


def test_across_the_date_line():
    _, east, _ = ORIGINS["date line"].local(-17.0, -179.99, 3.0)
    level = _normal(-17.0) * math.cos(_rad(-17.0))
    assert east == pytest.approx(_rad(0.02) * level, abs=0.01)


def _rad(degrees: float) -> float:
    return math.radians(degrees)


def _normal(latitude: float) -> float:
    return A / math.sqrt(1.0 - E2 * math.sin(_rad(latitude)) ** 2)


def _radius(latitude: float, azimuth: float) -> float:
    """Return Euler's radius of curvature in a direction (m)."""
    meridian = A * (1.0 - E2) / (1.0 - E2 * math.sin(_rad(latitude)) ** 2) ** 1.5
    a = _rad(azimuth)
    return 1.0 / (math.cos(a) ** 2 / meridian + math.sin(a) ** 2 / _normal(latitude))


def _ecef(latitude: float, longitude: float, height: float) -> np.ndarray:
    normal, lat, lon = _normal(latitude), _rad(latitude), _rad(longitude)
    level = (normal + height) * math.cos(lat)
    up = (normal * (1.0 - E2) + height) * math.sin(lat)
    return np.array([level * math.cos(lon), level * math.sin(lon), up])


def _tangent(origin: Origin, latitude: float, longitude: float) -> tuple[float, float]:
    here = _ecef(origin.latitude, origin.longitude, origin.altitude)
    gap = _ecef(latitude, longitude, origin.altitude) - here
    lat, lon = _rad(origin.latitude), _rad(origin.longitude)
    north = (-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat))
    return float(np.dot(north, gap)), float(np.dot((-math.sin(lon), math.cos(lon), 0.0), gap))
