"""How the gimbal is turned, by GIMBAL_DEVICE_ATTITUDE_STATUS, now and when a frame was taken.

Source: MAVLink common.xml, message 285. Pitch and roll are from the horizon; the yaw is from the
vehicle's nose, or from north where the flags say so.
"""

from __future__ import annotations

import math
from collections import deque
from typing import Final

from missionkit.geometry import to_euler, wrap, yaw_of
from missionkit.messages import GimbalAngles, GimbalReading
from missionkit.vehicle.link.message_cache import Cache, Fields
from missionkit.vehicle.telemetry import message_readings
from missionkit.vehicle.telemetry.ordered_arrivals import Arrivals

STATUS: Final = "GIMBAL_DEVICE_ATTITUDE_STATUS"
YAW_LOCK, IN_VEHICLE_FRAME, IN_EARTH_FRAME = 16, 32, 64  # GIMBAL_DEVICE_FLAGS
NEAR: Final = 0.15  # s between a frame and the reading that counts for it, at most
HEADING_AGE: Final = 0.5  # s, wall
KEPT: Final = 100  # readings


def angles_of(fields: Fields, cache: Cache) -> GimbalAngles | None:
    """Return the angles of a message; None: it does not know them, or the heading it needs.

    Args:
        fields: of the message.
        cache: with the vehicle's heading.
    """
    values = message_readings.numbers(fields, "q")
    q = message_readings.attitude(values) if len(values) == 4 else None
    if q is None:
        return None
    _, pitch, yaw = to_euler(q)
    flags = int(fields["flags"])
    if not flags & (IN_EARTH_FRAME | YAW_LOCK) or flags & IN_VEHICLE_FRAME:
        return GimbalAngles(pitch, yaw)
    body = cache.latest("ATTITUDE_QUATERNION", HEADING_AGE)
    turned = None if body is None else message_readings.turned(body.fields)
    return None if turned is None else GimbalAngles(pitch, wrap(yaw - yaw_of(turned)))


class GimbalReadings:
    """The gimbal's latest readings, in mission time.

    Args:
        cache: the newest messages.
        arrivals: queued messages with their times.
    """

    def __init__(self, cache: Cache, arrivals: Arrivals) -> None:
        self._cache = cache
        self._arrivals = arrivals
        self._known: deque[GimbalReading] = deque(maxlen=KEPT)

    def read(self, now: float) -> GimbalReading | None:
        """Return the newest reading that came since the last call, by `now` (s)."""
        newest = None
        for fields, at in self._arrivals.due(STATUS, now):
            angles = angles_of(fields, self._cache)
            if angles is not None:
                newest = GimbalReading(at, angles)
                self._known.append(newest)
        return newest

    def at(self, time: float) -> GimbalAngles | None:
        """Return how it was turned at a time (s, mission); None: no reading is near enough."""
        nearest = min(self._known, key=lambda it: abs(it.at - time), default=None)
        if nearest is None or math.fabs(nearest.at - time) > NEAR:
            return None
        return nearest.angles
