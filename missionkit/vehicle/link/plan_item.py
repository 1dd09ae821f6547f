"""Items of a fence or of rally points, exactly as MAVLink's MISSION_ITEM_INT has them."""

from __future__ import annotations

from typing import NamedTuple


class Item(NamedTuple):
    """One item; what its parameters mean depends on `command`."""

    seq: int
    command: int  # MAV_CMD
    x: int  # latitude, 1e-7 deg
    y: int  # longitude, 1e-7 deg
    z: float  # m
    mission_type: int  # 1 fence, 2 rally
    frame: int = 0  # MAV_FRAME_GLOBAL
    current: int = 0
    autocontinue: int = 1
    param1: float = 0.0
    param2: float = 0.0
    param3: float = 0.0
    param4: float = 0.0
