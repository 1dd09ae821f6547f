"""Corrects velocity setpoints for the error of the autopilot's own velocity.

An autopilot follows a setpoint by its own estimate of velocity. Where satellites are all it has,
that is wrong by 0.2 to 0.3 m/s for half a minute and more; a camera that sees a marker knows
better. Both estimates of the same moment are compared, and the difference is added:

    d += (1 - exp(-dt / τ)) (v_autopilot - v_own - d),  |d| <= LARGEST_CORRECTION,
    v_sent = v_wanted + d

While no target is seen, or the autopilot no longer says its velocity, d decays with the same τ:
what was true then is not true for ever.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Vec3, norm, vec
from missionkit.messages import Setpoint
from missionkit.vehicle.telemetry.observer import TimedVelocity

SMOOTHING = 0.25  # s, τ
LARGEST_CORRECTION = 1.5  # m/s
COMPARABLE_AGE = 0.5  # s; an older velocity is not compared
LONGEST_CORRECTION_STEP = 0.2  # s
FASTEST_COMPARED = 100.0  # m/s; what claims to be faster is not compared
HISTORY_KEPT = 1.0  # s of own velocities
NO_CORRECTION = vec(0.0, 0.0, 0.0)


class Correction(NamedTuple):
    """The current correction and the data it is based on; immutable."""

    offset: Vec3 = NO_CORRECTION  # (3,), m/s, NED
    at: float | None = None  # s, mission, of the last step
    own: tuple[TimedVelocity, ...] = ()  # recent, oldest first, without a gap


def step(
    last: Correction, now: float, own: TimedVelocity | None, reported: TimedVelocity | None
) -> Correction:
    """Return the correction at mission time `now` (s).

    Args:
        last: the one before.
        now: mission time.
        own: velocity by the mission's own estimate, None while no target is seen.
        reported: velocity by the autopilot's estimate, None if it never sent one.
    """
    heard = _remembered(last.own, own)
    dt = 0.0 if last.at is None else min(max(now - last.at, 0.0), LONGEST_CORRECTION_STEP)
    gap = _difference(heard, reported, now)
    aim = NO_CORRECTION if gap is None else gap
    offset = last.offset + (1.0 - math.exp(-dt / SMOOTHING)) * (aim - last.offset)
    return Correction(_bounded(offset), now, heard)


def corrected(setpoint: Setpoint, correction: Correction) -> Setpoint:
    """Return the setpoint with the correction added."""
    return setpoint._replace(velocity=setpoint.velocity + correction.offset)


def _remembered(
    kept: tuple[TimedVelocity, ...], own: TimedVelocity | None
) -> tuple[TimedVelocity, ...]:
    if own is None or not (math.isfinite(own.at) and _possible(own.velocity)):
        return ()
    return (*(each for each in kept if own.at - HISTORY_KEPT < each.at < own.at), own)


def _difference(
    own: tuple[TimedVelocity, ...], reported: TimedVelocity | None, now: float
) -> Vec3 | None:
    """Return v_autopilot - v_own (3,) at the moment of the former; None: not comparable."""
    if reported is None or not own or not abs(now - reported.at) <= COMPARABLE_AGE:
        return None
    if not _possible(reported.velocity):
        return None
    times = [each.at for each in own]
    velocities = np.array([each.velocity for each in own])
    there = [float(np.interp(reported.at, times, velocities[:, axis])) for axis in range(3)]
    return reported.velocity - vec(*there)


def _possible(velocity: Vec3) -> bool:
    return bool((np.abs(velocity) < FASTEST_COMPARED).all())  # False for NaN


def _bounded(offset: Vec3) -> Vec3:
    size = norm(offset)
    return offset if size <= LARGEST_CORRECTION else offset * (LARGEST_CORRECTION / size)
