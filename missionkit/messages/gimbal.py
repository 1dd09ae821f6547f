"""A gimbal that turns the camera: what it is to do, and how it is turned."""

from __future__ import annotations

from typing import NamedTuple

from missionkit.geometry import Vec3


class GimbalAngles(NamedTuple):
    """How a gimbal is turned, or is to be; it keeps the picture level."""

    pitch: float  # rad, from the horizon, upwards
    yaw: float  # rad, from the vehicle's nose, clockwise seen from above


class GimbalReading(NamedTuple):
    """How a gimbal was turned at a time."""

    at: float  # s
    angles: GimbalAngles


class GimbalAim(NamedTuple):
    """What a gimbal keeps doing until it gets another aim: one of the three."""

    angles: GimbalAngles | None = None  # to be turned so
    place: Vec3 | None = None  # (3,), m, NED, to look at
    target: str | None = None  # to look at, wherever it is believed to be
