"""Other vehicles of a fleet, as they report themselves."""

from __future__ import annotations

from typing import NamedTuple

from missionkit.geometry import Vec3


class TrafficReport(NamedTuple):
    """What another vehicle last said of itself, in the receiver's world and time."""

    at: float  # s, when it was valid
    position: Vec3  # (3,), m, NED
    velocity: Vec3  # (3,), m/s, NED
    in_air: bool


class OtherVehicle(NamedTuple):
    """Another vehicle of the fleet."""

    name: str
    report: TrafficReport | None = None  # the newest; None: nothing has been heard of it
    ended: bool = False  # its flight is over, by its own account
