"""What the navigator remembers and what it says."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.estimation import alignment, health
from missionkit.estimation.alignment import Alignment
from missionkit.estimation.facing import Facing
from missionkit.estimation.health import Tally
from missionkit.estimation.history import History
from missionkit.frames import ALWAYS, STILL, Timed
from missionkit.geometry import Mat, Quat, Vec3
from missionkit.messages import Health, Target


class Mark(NamedTuple):
    """What is known of one target besides its position, which is part of the filter's state."""

    facing: Facing = Facing()
    seen_at: float | None = None  # s, of the last accepted sighting
    strays: Mat = np.empty((0, 3))  # (n, 3), m, NED: where sightings refused in a row put it


class NavMemory(NamedTuple):
    """All the navigator knows; picklable, and never changed."""

    now: float  # s, of the last observation
    heard: Alignment  # until aligned
    last: Vec3  # (7,) newest inertial sample: time, accel, gyro
    past: History | None  # None until aligned
    tally: Tally
    marks: tuple[Mark, ...]  # one per target, in the order they were given
    corrections: tuple[Timed, ...]  # world <- odom: the sum of all resets of the position
    broken: bool  # the last observation was left out, since its result was not finite
    parked: bool = False  # the autopilot last said: on the ground, disarmed
    missing: float = 0.0  # s, length of a gap in the inertial samples, until aligned again


class NavState(NamedTuple):
    """What the navigator believes, at the time of the newest inertial sample."""

    position: Vec3  # (3,), m, NED
    velocity: Vec3  # (3,), m/s, NED
    attitude: Quat  # (4,), body to world
    rates: Vec3  # (3,), rad/s, FRD, without bias
    health: Health
    targets: dict[str, Target]
    covariance: Mat  # (15, 15) of δp, δv, δθ (body, rad), δb_a, δb_g
    correction: Vec3  # (3,), m, NED: the sum of all resets of the position
    late: int  # measurements dropped because they came too late


def begin(targets: int) -> NavMemory:
    """Return the memory before the first observation."""
    return NavMemory(
        now=0.0,
        heard=alignment.begin(),
        last=np.array([-math.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        past=None,
        tally=health.begin(),
        marks=(Mark(),) * targets,
        corrections=(Timed(ALWAYS, STILL),),
        broken=False,
    )
