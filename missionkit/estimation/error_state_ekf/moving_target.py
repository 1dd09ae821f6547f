"""A target that moves: its place and velocity from its sightings, apart from the filter's state.

It tells nothing about where the vehicle is, so it corrects nothing.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Vec3
from missionkit.messages import Target

JITTER = 0.03  # m, by which the vehicle's own estimate moves from one correction to the next
FORGOTTEN = 3.0  # s without a sighting, after which it begins with the next one
STRAY = 9  # sightings refused in a row, after which it begins with the next one


class TargetMotion(NamedTuple):
    """Place and level velocity, and their variances, alike on every axis."""

    at: float  # s, of the last sighting
    position: Vec3  # (3,), m, NED
    velocity: Vec3  # (3,), m/s, NED, level
    place: float  # m²
    both: float  # m²/s
    speed: float  # m²/s²
    strays: int = 0  # sightings refused in a row


def begun(at: float, place: Vec3, sd: float, fastest: float) -> TargetMotion:
    """Return the motion after the first sighting: at most `fastest`, whichever way.

    Args:
        at: s, of the sighting.
        place: (3,), m, NED, where it puts the target.
        sd: m, of that.
        fastest: m/s.
    """
    return TargetMotion(at, place, np.zeros(3), sd * sd, 0.0, (0.5 * fastest) ** 2)


def predicted(motion: TargetMotion, at: float, accel: float) -> TargetMotion:
    """Return the motion at a time, by constant velocity and white acceleration.

    Source: Bar-Shalom, Li and Kirubarajan, 2001, section 6.2.2.

    Args:
        motion: at its last sighting.
        at: s.
        accel: m/s²/√Hz.
    """
    dt, q = at - motion.at, accel * accel
    return motion._replace(
        at=at,
        position=motion.position + dt * motion.velocity,
        place=motion.place + 2.0 * dt * motion.both + dt * dt * motion.speed + q * abs(dt) ** 3 / 3,
        both=motion.both + dt * motion.speed + 0.5 * q * dt * abs(dt),
        speed=motion.speed + q * abs(dt),
    )


def sighted(
    motion: TargetMotion | None,
    at: float,
    place: Vec3,
    sd: float,
    gate: float,
    accel: float,
    fastest: float,
) -> TargetMotion:
    """Return the motion after a sighting; one that fails the gate changes nothing.

    Args:
        motion: until then; None: not seen yet.
        at: s, of the exposure.
        place: (3,), m, NED, where it puts the target.
        sd: m, of that, one axis.
        gate: squared Mahalanobis distance that is accepted.
        accel: m/s²/√Hz.
        fastest: m/s.
    """
    sd = math.hypot(sd, JITTER)
    if motion is None or at - motion.at > FORGOTTEN or motion.strays >= STRAY:
        return begun(at, place, sd, fastest)
    if at <= motion.at:
        return motion
    now = predicted(motion, at, accel)
    total = now.place + sd * sd
    off = place - now.position
    if float(off @ off) > gate * total:
        return motion._replace(strays=motion.strays + 1)
    k, g = now.place / total, now.both / total
    velocity = now.velocity + g * off
    velocity[2] = 0.0
    size = math.hypot(velocity[0], velocity[1])
    if size > fastest:
        velocity *= fastest / size
    return TargetMotion(
        at,
        now.position + k * off,
        velocity,
        now.place * (1.0 - k),
        now.both * (1.0 - k),
        now.speed - g * now.both,
    )


def target_of(name: str, motion: TargetMotion, now: float, accel: float) -> Target:
    """Return the target as it is at `now` (s).

    Args:
        name: of the target.
        motion: at its last sighting.
        now: s.
        accel: m/s²/√Hz.
    """
    ahead = predicted(motion, now, accel)
    sd = math.sqrt(max(ahead.place, 0.0))
    return Target(name, ahead.position, sd, None, None, motion.at, motion.velocity.copy())
