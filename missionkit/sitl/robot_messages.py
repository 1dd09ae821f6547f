"""Where the simulated ground robots are: DEBUG_FLOAT_ARRAY `robots`, for a camera that is drawn.

Three numbers a robot, in the order of the world file: north and east (m), heading (rad); those of a
robot that is out of play are `GONE`. No real autopilot sends this.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from missionkit.sim.ground_robots import OUT
from missionkit.sitl.pymavlink_dialect import Message, mavlink
from missionkit.sitl.sitl_state import SitlState

NAME: Final = b"robots"
ROOM: Final = 58  # numbers in the message
MOST: Final = ROOM // 3  # robots
GONE: Final = 1e6


def debug_float_array(state: SitlState) -> Message | None:
    """Return the poses of the first `MOST` robots; None: there are none."""
    robots = state.body.robots[:MOST]
    if not len(robots):
        return None
    poses = np.where(robots[:, OUT, None] > 0.0, GONE, robots[:, :3])
    data = np.zeros(ROOM)
    data[: poses.size] = poses.ravel()
    return mavlink.MAVLink_debug_float_array_message(state.micros, NAME, 0, data.tolist())
