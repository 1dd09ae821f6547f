"""The world's origin of a flight: the mission's where it has one, else the vehicle's home.

North and east of a mission with an `origin` are measured from there, wherever the vehicle was
armed, so that it flies to the places that were meant. Down is always measured from home: a
barometer measures from there, and take-off, landing and the ground are there.
"""

from __future__ import annotations

from typing import NamedTuple

from missionkit.geodesy import Origin

FARTHEST = 10_000.0  # m, home from the mission's origin
MOST_ALTITUDE = 5.0  # m, between two altitudes above mean sea level of the take-off point
MOST_UNMEASURED = 3.0  # m, home from the origin, where the navigator does not know of it


class MissionOrigin(NamedTuple):
    """What a mission says of its origin."""

    origin: Origin
    amsl: bool = False  # it has positions above mean sea level
    by_fixes: bool = True  # its navigator measures from the origin, not from where it was armed


def world_origin(wanted: MissionOrigin | None, home: Origin) -> Origin:
    """Return where [0, 0, 0] is on the earth."""
    return home if wanted is None else wanted.origin._replace(altitude=home.altitude)


def misplacement(wanted: MissionOrigin | None, home: Origin) -> str:
    """Say why a mission cannot be flown from a home, "" if it can."""
    if wanted is None:
        return ""
    origin = wanted.origin
    far = origin.distance(home.latitude, home.longitude)
    if far > FARTHEST:
        return (
            f"home ({home.latitude:.6f}, {home.longitude:.6f}) is {far / 1e3:,.1f} km from the "
            f"mission's origin ({origin.latitude:.6f}, {origin.longitude:.6f}): correct 'origin', "
            "or take off near it"
        )
    if not wanted.by_fixes and far > MOST_UNMEASURED:
        return (
            f"home is {far:.1f} m from the mission's origin, and the navigator, which uses no "
            "fixes, measures from home: take off at the origin"
        )
    off = home.altitude - origin.altitude
    if wanted.amsl and abs(off) > MOST_ALTITUDE:
        return (
            f"the vehicle puts home at {home.altitude:.1f} m above mean sea level, the mission its "
            f"origin at {origin.altitude:.1f} m: positions with 'amsl' would be {abs(off):.1f} m "
            f"too {'high' if off > 0.0 else 'low'}; correct 'alt', or give heights above_home"
        )
    return ""
