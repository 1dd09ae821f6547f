"""Home as the autopilot gives it: on the earth, and in its local frame.

HOME_POSITION holds both, but either may be left zero: latitude and longitude until there is a home,
and x, y, z by autopilots that do not fill them in. Where home lies in the local frame then follows
from GPS_GLOBAL_ORIGIN, the place of that frame's origin.
"""

from __future__ import annotations

from missionkit.geodesy import Origin
from missionkit.geometry import Vec3
from missionkit.vehicle.link.message_cache import Cache, Message
from missionkit.vehicle.telemetry import message_readings


def home_message(cache: Cache) -> Message | None:
    """Return HOME_POSITION, None while there is none, or it says no place."""
    home = cache.latest("HOME_POSITION")
    if home is None or (int(home["latitude"]) == 0 and int(home["longitude"]) == 0):
        return None
    return home


def place_of(message: Message) -> Origin:
    """Return the place on the earth of HOME_POSITION or GPS_GLOBAL_ORIGIN."""
    degrees = 1e-7 * message["latitude"], 1e-7 * message["longitude"]
    return Origin(*degrees, 1e-3 * message["altitude"])


def local_home(cache: Cache, *, by_degrees: bool = False) -> Vec3 | None:
    """Return home in the autopilot's local frame, (3,), m; None: not known.

    With `by_degrees` x, y, z do not count. Zeros count as unset where GPS_GLOBAL_ORIGIN is known:
    it gives the same if they were meant.
    """
    home = home_message(cache)
    if home is None:
        return None
    surface = message_readings.triple(home.fields, "x", "y", "z")
    if surface is not None and surface.any() and not by_degrees:
        return surface
    origin = cache.latest("GPS_GLOBAL_ORIGIN")
    if origin is None:
        return surface
    at = place_of(home)
    return place_of(origin).local(at.latitude, at.longitude, at.altitude)
