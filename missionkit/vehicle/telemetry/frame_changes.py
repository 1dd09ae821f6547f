"""Notices that an armed vehicle's home, or the origin of its local frame, moves.

The mission's own origin stays where it was: its estimate is made of raw fixes. But the autopilot
returns to the new home, and a position in its local frame means another place from now on. Where
home lies in the new frame follows from the two messages' degrees: x, y, z of HOME_POSITION may be
of the old frame.
"""

from __future__ import annotations

import math

from missionkit.geodesy import Origin
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.telemetry.home_position import place_of

MOVED = 1.0  # m, level or in height
HOME_MOVED, ORIGIN_MOVED = "home_moved", "origin_moved"
SAYS = {
    HOME_MOVED: "the autopilot's home has moved by {:.1f} m: it returns there; the mission's home "
    "and origin stay",
    ORIGIN_MOVED: "the origin of the autopilot's local frame has moved by {:.1f} m: positions "
    "are sent in the new frame; the mission's own origin stays",
}
_MESSAGES = {HOME_MOVED: "HOME_POSITION", ORIGIN_MOVED: "GPS_GLOBAL_ORIGIN"}


class FrameChanges:
    """Compares where they are with where they were when the vehicle was last disarmed."""

    def __init__(self, cache: Cache) -> None:
        self._cache = cache
        self._before: dict[str, Origin] = {}
        self.origin_moved = False

    def seen(self, *, armed: bool) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Return events and sentences on what has moved since the last call."""
        events, sentences = [], []
        for event, name in _MESSAGES.items():
            message = self._cache.latest(name)
            if message is None or not (message["latitude"] or message["longitude"]):
                continue
            place = place_of(message)
            moved = _apart(self._before.get(event, place), place)
            if armed and moved > MOVED:
                events.append(event)
                sentences.append(SAYS[event].format(moved))
                self.origin_moved = self.origin_moved or event == ORIGIN_MOVED
            if not armed or moved > MOVED or event not in self._before:
                self._before[event] = place
        return tuple(events), tuple(sentences)


def _apart(one: Origin, other: Origin) -> float:
    north, east, down = one.local(other.latitude, other.longitude, other.altitude).tolist()
    return float(max(math.hypot(north, east), abs(down)))
