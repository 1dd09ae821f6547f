"""The estimate that guards and behaviours see."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple, Self

from missionkit.geometry import Quat, Vec3, yaw_of
from missionkit.messages.gimbal import GimbalReading
from missionkit.messages.observation import (
    NO_CYCLE,
    Battery,
    Cycle,
    Points,
    Range,
    VehicleStatus,
)
from missionkit.messages.occupancy import Occupancy
from missionkit.messages.traffic import OtherVehicle
from missionkit.messages.vision import GroundFrame, Look, Sighting

_new = tuple.__new__


class Target(NamedTuple):
    """Estimated position of a target, and how it moves if it was tracked."""

    name: str
    position: Vec3  # (3,), m, NED, of the marker's centre
    position_sd: float  # m, one axis, relative to the vehicle
    attitude: Quat | None  # marker axes (x right, y up, z towards the viewer) to world
    angle_sd: float | None  # rad
    seen_at: float | None  # s, None when only the mission file says where it is
    velocity: Vec3 | None = None  # (3,), m/s, NED, None: not tracked
    heading: float | None = None  # rad, clockwise from north, where it drives when it drives
    heading_sd: float | None = None  # rad
    modes: Mapping[str, float] = MappingProxyType({})  # probability of each model of motion
    classes: Mapping[str, float] = MappingProxyType({})  # probability of each kind of object
    confidence: float | None = None  # 0 to 1, share of the last frames in which it was detected
    reversal_in: float | None = None  # s, until it next turns round by its clock; None: not known
    spin_left: float | None = None  # s, of the half turn that it is in; None: none, or not known


class Health(NamedTuple):
    """Health of the estimate."""

    aligned: bool  # initial attitude, position and biases found
    diverged: bool  # measurements keep being rejected or the covariance exploded
    gnss_at: float | None  # s, last accepted fix
    vision_at: float | None  # s, last accepted visual pose
    position_sd: float  # m, horizontal, 1 sigma
    rejected: int  # measurements in a row that failed the gate
    placed: bool = True  # the position has a source: a recent fix or sighting, or flow
    height_sd: float | None = None  # m, 1 sigma, None: not known
    resets: int = 0  # how often the position was reset to rejected measurements
    misfit: str = ""  # how the sightings contradict the filter's noise, if they do
    cause: str = ""  # why it has diverged, "GNSS jumped 20 m", if the navigator says
    mahalanobis: float | None = None  # 1, of the innovations lately, in standard deviations


class Goal(NamedTuple):
    """Where the active behaviour is going."""

    position: Vec3  # (3,), m, NED
    yaw: float | None  # rad, None if any
    at: float  # s, when it was last computed
    target: str | None = None


class Estimate(NamedTuple):
    """The estimate at one tick; guards and behaviours see nothing else."""

    now: float
    position: Vec3  # (3,), m, NED
    velocity: Vec3  # (3,), m/s, NED
    attitude: Quat  # (4,), body to world
    rates: Vec3  # (3,), rad/s, FRD
    health: Health
    battery: Battery | None = None
    status: VehicleStatus | None = None
    home: Vec3 | None = None  # (3,), m, NED, set when the vehicle armed
    targets: Mapping[str, Target] = MappingProxyType({})
    looks: tuple[Look, ...] = ()  # frames due since the last tick
    sightings: tuple[Sighting, ...] = ()
    obstacles: Points | None = None  # (N, 3), m, NED; None: no fresh scan
    scanned_at: float | None = None  # s, when the newest scan was measured, fresh or not
    scan_range: float = math.inf  # m, how far that scan sees; inf: it does not say
    events: tuple[str, ...] = ()
    cycle: Cycle = NO_CYCLE
    map: Occupancy | None = None  # the mission's
    range: Range | None = None  # the newest distance to the ground, fresh or not
    failing: tuple[str, ...] = ()  # plug-ins that misbehaved at the last tick, and how
    ground: GroundFrame | None = None  # objects in the frame that came since the last tick
    traffic: tuple[OtherVehicle, ...] = ()  # all other vehicles of the fleet
    gimbal: GimbalReading | None = None  # the newest, fresh or not
    operator_silence: float | None = None  # s, of the pilot at the page; None: no pilot has come
    utc: float | None = None  # s since 1970; None: not known
    # where the chart stands, as of the last tick:
    state: str = ""
    entered_at: float = 0.0  # s
    done: bool = False  # the state's behaviour says it has finished
    goal: Goal | None = None

    def standing(
        self, state: str, entered_at: float, *, done: bool = False, goal: Goal | None = None
    ) -> Self:
        """Return the same estimate for another state of the chart.

        Args:
            state: that is active.
            entered_at: s.
            done: its behaviour has finished.
            goal: of its behaviour.
        """
        return _new(type(self), (*self[:-4], state, entered_at, done, goal))

    @property
    def yaw(self) -> float:
        """Heading (rad)."""
        return yaw_of(self.attitude)
