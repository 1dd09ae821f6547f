"""What flows through the house: observation -> estimate -> verdicts -> command -> record.

Frames: world NED (m) with its origin at the take-off point, body FRD, camera as in OpenCV.
Quaternions (w, x, y, z), body to world. SI units, radians, seconds on the mission's clock.
A thing that is not known is `None`, never NaN.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from missionkit.geometry import Quat, Transform, Vec3, yaw_of

Image = npt.NDArray[np.uint8]  # (height, width) grey or (height, width, 3) BGR
Points = npt.NDArray[np.float64]  # (N, 3), m


# --- observation: what sensors said, each with its time -------------------------------------------


class Imu(NamedTuple):
    """One inertial sample."""

    at: float  # s
    accel: Vec3  # (3,), m/s², FRD, specific force: (0, 0, -g) at rest
    gyro: Vec3  # (3,), rad/s, FRD


class Gnss(NamedTuple):
    """One position fix; `at` is when it was valid, which is before it arrived."""

    at: float  # s
    position: Vec3  # (3,), m, NED
    velocity: Vec3  # (3,), m/s, NED
    position_sd: Vec3  # (3,), m
    velocity_sd: float  # m/s


class Baro(NamedTuple):
    """One barometric height."""

    at: float  # s
    height: float  # m above the origin, up


class Magnetometer(NamedTuple):
    """One magnetic field sample."""

    at: float  # s
    field: Vec3  # (3,), unit length, FRD


class Frame(NamedTuple):
    """One camera frame; `at` is the middle of the exposure, which is before it arrived.

    A simulated camera that does not render gives `corners` instead of an image: for each marker
    in view its dictionary, id and its four image points (4, 2), px.
    """

    at: float  # s
    image: Image | None
    corners: tuple[tuple[str, int, npt.NDArray[np.float64]], ...] | None = None


class Scan(NamedTuple):
    """Nearest surfaces around the vehicle, as MAVLink's OBSTACLE_DISTANCE gives them."""

    at: float  # s
    points: Points  # (N, 3), m, FRD, only the directions that hit something


class Battery(NamedTuple):
    """State of the battery."""

    at: float  # s
    charge: float  # 0 to 1
    voltage: float  # V


class VehicleStatus(NamedTuple):
    """What the autopilot says about itself."""

    at: float  # s, time of the last heartbeat
    armed: bool
    in_air: bool
    ready: bool  # passes its own arming checks
    mode: str  # autopilot's mode, lower case: hold, offboard, land, ...


class Cycle(NamedTuple):
    """How long one tick took, and how many so far exceeded their budget."""

    sense: float = 0.0  # s, image and estimation
    process: float = 0.0  # s, guards and chart
    control: float = 0.0  # s, behaviour and control
    overruns: int = 0

    @property
    def total(self) -> float:
        """Whole cycle (s)."""
        return self.sense + self.process + self.control


NO_CYCLE = Cycle()


@dataclass(frozen=True, slots=True)
class Observation:
    """Everything that arrived since the last tick; `None` or empty where nothing did."""

    now: float
    imu: tuple[Imu, ...] = ()
    gnss: Gnss | None = None
    baro: Baro | None = None
    mag: Magnetometer | None = None
    frame: Frame | None = None
    scan: Scan | None = None
    battery: Battery | None = None
    status: VehicleStatus | None = None
    events: tuple[str, ...] = ()  # from the operator or the vehicle
    cycle: Cycle = NO_CYCLE  # of the tick before


# --- estimate: what guards and behaviours see -----------------------------------------------------


@dataclass(frozen=True, slots=True)
class CameraModel:
    """A calibrated pinhole camera and where it sits on the body."""

    width: int
    height: int
    matrix: npt.NDArray[np.float64]  # (3, 3), px
    distortion: npt.NDArray[np.float64]  # (5,) k1 k2 p1 p2 k3
    mount: Transform  # camera to body FRD
    period: float  # s between frames


class Detection(NamedTuple):
    """One marker found in one frame."""

    dictionary: str
    id: int
    corners: npt.NDArray[np.float64]  # (4, 2), px, OpenCV's order: top left, then clockwise
    area: float  # px²


class Sighting(NamedTuple):
    """The pose of one target's marker, measured from one frame."""

    at: float  # s, of the exposure
    target: str
    id: int
    pose: Transform  # marker to camera
    position_sd: float  # m, along the line of sight
    angle_sd: float  # rad, of the marker's orientation
    error: float  # px, rms reprojection error
    ambiguous: bool  # both planar solutions remained plausible: the orientation is not to be used
    detection: Detection


class Look(NamedTuple):
    """What one expected frame showed. A frame that never came is a look that saw nothing."""

    at: float  # s
    seen: frozenset[str]  # names of the targets found
    silent: bool = False  # the frame was missing or a repetition


class Target(NamedTuple):
    """Where a target is believed to be."""

    name: str
    position: Vec3  # (3,), m, NED, of the marker's centre
    position_sd: float  # m, one axis, relative to the vehicle
    attitude: Quat | None  # marker axes (x right, y up, z towards the viewer) to world
    angle_sd: float | None  # rad
    seen_at: float | None  # s, None when only the mission file says where it is


class Health(NamedTuple):
    """How far the estimate can be trusted."""

    aligned: bool  # initial attitude, position and biases found
    diverged: bool  # measurements keep being rejected or the covariance exploded
    gnss_at: float | None  # s, last accepted fix
    vision_at: float | None  # s, last accepted visual pose
    position_sd: float  # m, horizontal, 1 sigma
    rejected: int  # measurements in a row that failed the gate


class Goal(NamedTuple):
    """Where the active behaviour is going."""

    position: Vec3  # (3,), m, NED
    yaw: float | None  # rad, None when it does not matter
    at: float  # s, when it was last computed
    target: str | None = None


@dataclass(frozen=True, slots=True)
class Estimate:
    """What is known at one tick. Guards and behaviours see this and nothing else."""

    now: float
    position: Vec3  # (3,), m, NED
    velocity: Vec3  # (3,), m/s, NED
    attitude: Quat  # (4,), body to world
    rates: Vec3  # (3,), rad/s, FRD
    health: Health
    battery: Battery | None = None
    status: VehicleStatus | None = None
    home: Vec3 | None = None  # (3,), m, NED, set when the vehicle armed
    targets: Mapping[str, Target] = field(default_factory=dict)
    looks: tuple[Look, ...] = ()  # frames due since the last tick
    sightings: tuple[Sighting, ...] = ()
    obstacles: Points | None = None  # (N, 3), m, NED; None: no fresh scan
    events: tuple[str, ...] = ()
    cycle: Cycle = NO_CYCLE
    failing: tuple[str, ...] = ()  # plug-ins that misbehaved at the last tick, and how
    # where the chart stands, as of the last tick:
    state: str = ""
    entered_at: float = 0.0  # s
    done: bool = False  # the state's behaviour says it has finished
    goal: Goal | None = None

    @property
    def yaw(self) -> float:
        """Heading (rad)."""
        return yaw_of(self.attitude)


# --- verdicts -------------------------------------------------------------------------------------


class Verdict(NamedTuple):
    """What a guard says: it holds, does not, or cannot tell (`holds is None`), and why."""

    holds: bool | None
    why: str = ""
    value: float | None = None
    threshold: float | None = None
    margin: float | None = None  # how far inside (positive) or outside (negative) the guard is

    @classmethod
    def unknown(cls, why: str) -> Verdict:
        """Return a verdict that nothing can be said."""
        return cls(None, why)

    @classmethod
    def below(cls, value: float, threshold: float, why: str = "") -> Verdict:
        """Holds when `value` < `threshold`."""
        return cls(value < threshold, why, value, threshold, threshold - value)

    @classmethod
    def above(cls, value: float, threshold: float, why: str = "") -> Verdict:
        """Holds when `value` > `threshold`."""
        return cls(value > threshold, why, value, threshold, value - threshold)

    @classmethod
    def at_least(cls, value: float, threshold: float, why: str = "") -> Verdict:
        """Holds when `value` >= `threshold`."""
        return cls(value >= threshold, why, value, threshold, value - threshold)

    @classmethod
    def at_most(cls, value: float, threshold: float, why: str = "") -> Verdict:
        """Holds when `value` <= `threshold`."""
        return cls(value <= threshold, why, value, threshold, threshold - value)


# --- command --------------------------------------------------------------------------------------


class Action(StrEnum):
    """A discrete request to the autopilot."""

    ARM = "arm"
    TAKE_OFF = "take_off"
    HOLD = "hold"
    LAND = "land"
    DISARM = "disarm"


class Setpoint(NamedTuple):
    """A velocity to fly until the next command."""

    velocity: Vec3  # (3,), m/s, NED
    yaw_rate: float  # rad/s, clockwise seen from above


class Command(NamedTuple):
    """What goes to the vehicle at one tick. Neither part: let the autopilot hold."""

    setpoint: Setpoint | None = None
    action: Action | None = None
    height: float | None = None  # m, with TAKE_OFF
    payload: str | None = None  # name of the actuator to be on during this tick


class Mode(StrEnum):
    """P1's control modes: each has its gains."""

    NONE = "none"  # the autopilot flies by itself: on the ground, taking off, landing
    GPS = "gps"
    VISUAL = "visual"
    TRAJECTORY = "trajectory"


class Guidance(NamedTuple):
    """What a behaviour wants; control turns it into a setpoint."""

    position: Vec3  # (3,), m, NED, desired
    speed: float  # m/s, not to be exceeded
    velocity: Vec3 | None = None  # (3,), m/s, NED, reference velocity to feed forward
    yaw: float | None = None  # rad; None: P1's hybrid yaw law chooses
    avoid: bool = True  # let the potential field push away from obstacles


class Step(NamedTuple):
    """What a behaviour answers at one tick."""

    guidance: Guidance | None = None  # None and no action: hold still
    action: Action | None = None
    height: float | None = None  # m, with TAKE_OFF
    payload: str | None = None
    done: bool = False
    goal: Goal | None = None
    note: str = ""  # shown in the live view and the record
    memory: Any = None  # given back to the behaviour at the next tick


# --- record ---------------------------------------------------------------------------------------


class Fired(NamedTuple):
    """A transition that was taken, and why."""

    source: str
    to: str
    reason: str  # "failsafe battery", "when converged for 1.0 s", "after 120 s", "operator: land"
    verdicts: tuple[tuple[str, Verdict], ...]  # the guards that decided, by name
    outputs: tuple[str, ...]  # Mealy, control mode first: "mode visual", "log ..."


class Record(NamedTuple):
    """Everything one tick decided."""

    now: float
    state: str
    mode: Mode
    verdicts: tuple[tuple[str, Verdict], ...]  # every guard that was asked this tick
    fired: Fired | None
    command: Command
    step_note: str
    problems: tuple[str, ...]  # invariant violations, contained plug-in errors
    estimate: Estimate
    cycle: Cycle = NO_CYCLE  # wall time of this tick, as the shell measured it
