"""A command, as COMMAND_LONG and COMMAND_INT both mean it.

https://mavlink.io/en/services/command.html
"""

from __future__ import annotations

import math
from typing import NamedTuple

from missionkit.geometry import Vec3
from missionkit.sitl.geodetic import GeographicPoint
from missionkit.sitl.mission_progress import RELATIVE_FRAMES
from missionkit.sitl.peer_channel import Channel, Sender, sender
from missionkit.sitl.pymavlink_dialect import Message, mavlink
from missionkit.sitl.sitl_state import SitlState


class CommandFields(NamedTuple):
    """One command; `None` where a parameter is NaN."""

    command: int
    params: tuple[float | None, float | None, float | None, float | None]
    latitude: float | None  # deg; param5 of commands without a place
    longitude: float | None  # deg; param6
    height: float | None  # m; param7
    frame: int
    channel: Channel
    who: Sender

    def number(self, index: int) -> float:
        """Return param1 to param4, 0 where it is NaN."""
        return self.params[index - 1] or 0.0

    def place(self, state: SitlState, otherwise: Vec3) -> Vec3:
        """Return where it says, (3,), m, NED; from `otherwise` what it leaves out."""
        spot = state.earth.spot(otherwise)
        height = spot.height
        if self.height is not None:
            home = state.earth.origin.height - float(state.home[2])
            height = self.height + (home if self.frame in RELATIVE_FRAMES else 0.0)
        unknown = self.latitude is None or self.longitude is None
        if unknown or (self.latitude == 0.0 and self.longitude == 0.0):
            return state.earth.position(spot._replace(height=height))
        return state.earth.position(
            GeographicPoint(self.latitude or 0.0, self.longitude or 0.0, height)
        )


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def order_of(message: Message, channel: Channel) -> CommandFields:
    """Return the command in a COMMAND_LONG or COMMAND_INT."""
    first = (message.param1, message.param2, message.param3, message.param4)
    p1, p2, p3, p4 = map(_finite, first)
    if message.get_type() == "COMMAND_LONG":
        place = (_finite(message.param5), _finite(message.param6), _finite(message.param7))
        frame = mavlink.MAV_FRAME_GLOBAL
    else:
        unset = 2**31 - 1  # INT32_MAX
        x = None if message.x == unset else message.x / 1e7
        y = None if message.y == unset else message.y / 1e7
        place, frame = (x, y, _finite(message.z)), message.frame
    return CommandFields(message.command, (p1, p2, p3, p4), *place, frame, channel, sender(message))
