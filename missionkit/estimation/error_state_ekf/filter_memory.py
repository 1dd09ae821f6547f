"""Memory of the filter between observations."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.estimation.error_state_ekf import initialization, innovation_monitor
from missionkit.estimation.error_state_ekf.initialization import RestSamples
from missionkit.estimation.error_state_ekf.innovation_monitor import InnovationMonitor
from missionkit.estimation.error_state_ekf.moving_target import TargetMotion
from missionkit.estimation.error_state_ekf.replay_buffer import ReplayBuffer
from missionkit.estimation.error_state_ekf.target_attitude import TargetAttitude
from missionkit.frames import FROM_THE_START, NO_MOTION, Timed
from missionkit.geometry import Mat, Vec3


class TargetTrack(NamedTuple):
    """Track of one target, without its position, which is part of the filter's state."""

    facing: TargetAttitude = TargetAttitude()
    seen_at: float | None = None  # s, of the last accepted sighting
    strays: Mat = np.empty((0, 3))  # (n, 3), m, NED: where sightings refused in a row put it
    motion: TargetMotion | None = None  # of one that moves, once it was seen


class FilterMemory(NamedTuple):
    """All the navigator knows; picklable, and never changed."""

    now: float  # s, of the last observation
    heard: RestSamples  # until aligned
    last: Vec3  # (7,) newest inertial sample: time, accel, gyro
    past: ReplayBuffer | None  # None until aligned
    monitor: InnovationMonitor
    tracks: tuple[TargetTrack, ...]  # one per target, in the order they were given
    corrections: tuple[Timed, ...]  # world <- odom: the sum of all resets of the position
    broken: bool  # the last observation was left out, since its result was not finite
    parked: bool = False  # the autopilot's last report: on the ground, disarmed
    missing: float = 0.0  # s, length of a gap in the inertial samples, until aligned again


def begin(targets: int) -> FilterMemory:
    """Return the memory before the first observation."""
    return FilterMemory(
        now=0.0,
        heard=initialization.begin(),
        last=np.array([-math.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        past=None,
        monitor=innovation_monitor.begin(),
        tracks=(TargetTrack(),) * targets,
        corrections=(Timed(FROM_THE_START, NO_MOTION),),
        broken=False,
    )
