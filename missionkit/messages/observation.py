"""Sensor readings, each with its time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from missionkit.geometry import Quat, Vec3
from missionkit.messages.gimbal import GimbalAngles, GimbalReading
from missionkit.messages.operator import OperatorReport
from missionkit.messages.traffic import OtherVehicle
from missionkit.messages.vision import BoxDetection

Image = npt.NDArray[np.uint8]  # (height, width) grey or (height, width, 3) BGR
Points = npt.NDArray[np.float64]  # (N, 3), m


class Imu(NamedTuple):
    """One inertial sample."""

    at: float  # s
    accel: Vec3  # (3,), m/s², FRD, specific force: (0, 0, -g) at rest
    gyro: Vec3  # (3,), rad/s, FRD


class Gnss(NamedTuple):
    """One position fix; `at` is when it was valid, which is before it arrived."""

    at: float  # s
    position: Vec3  # (3,), m, NED
    velocity: Vec3 | None  # (3,), m/s, NED; None: the receiver does not know it
    position_sd: Vec3  # (3,), m
    velocity_sd: float | Vec3  # m/s, for all axes or (3,); infinite: that axis is not known


class Baro(NamedTuple):
    """One barometric height."""

    at: float  # s
    height: float  # m above the origin, up


class Magnetometer(NamedTuple):
    """One magnetic field sample."""

    at: float  # s
    field: Vec3  # (3,), unit length, FRD


class OpticalFlow(NamedTuple):
    """How fast the ground passes below, as MAVLink's OPTICAL_FLOW_RAD gives it.

    Means over the interval that ends `at`. A point of the ground on the sensor's axis, down in the
    body, moves in the picture by `flow`, turns of the vehicle included; the sensor's own
    gyroscope says what it makes of those.
    """

    at: float  # s
    flow: npt.NDArray[np.float64]  # (2,), rad/s, of the image towards the body's x and y
    rates: Vec3 | None  # (3,), rad/s, FRD, bias included; None: it has no gyroscope of its own
    over: float  # s, length of the interval
    quality: float  # 0 to 1; 0: nothing was measured


class Range(NamedTuple):
    """Distance to the ground."""

    at: float  # s
    distance: float  # m, along the body's z


class ExternalPose(NamedTuple):
    """Pose of the vehicle as something outside measures it, such as motion capture."""

    at: float  # s, when it was valid, which is before it arrived
    position: Vec3  # (3,), m, NED
    attitude: Quat  # (4,), body to world
    position_sd: float  # m, each axis
    angle_sd: float  # rad, about each axis


class AnchorRange(NamedTuple):
    """One radio range from the vehicle's radio to an anchor, by time of flight."""

    at: float  # s
    anchor: str  # name of the anchor in the mission's navigation
    distance: float  # m


class Features(NamedTuple):
    """Feature points of a target that a camera measured, each with its name.

    The camera's own processing has turned pixels to points in its frame (P3, section III).
    """

    at: float  # s
    target: str
    names: tuple[str, ...]  # of the features in view
    points: Points  # (N, 3), m, camera frame: x right, y down, z forward


class Frame(NamedTuple):
    """One camera frame; `at` is the middle of the exposure, which is before it arrived.

    A simulated camera that does not render gives `corners` instead of an image: for each marker
    in view its dictionary, id and its four image points (4, 2), px; and `boxes`, what detectors of
    ground robots would find.
    """

    at: float  # s
    image: Image | None
    corners: tuple[tuple[str, int, npt.NDArray[np.float64]], ...] | None = None
    boxes: tuple[BoxDetection, ...] | None = None
    gimbal: GimbalAngles | None = None  # how it was turned then; None: not known, or there is none


class Scan(NamedTuple):
    """Nearest surfaces around the vehicle, as MAVLink's OBSTACLE_DISTANCE gives them."""

    at: float  # s, when it was measured, which is before it arrived
    points: Points  # (N, 3), m, FRD, only the directions that hit something
    range: float = math.inf  # m, how far it sees; inf: it does not say


class Battery(NamedTuple):
    """State of the battery."""

    at: float  # s
    charge: float  # 0 to 1
    voltage: float  # V


class VehicleStatus(NamedTuple):
    """Status reported by the autopilot."""

    at: float  # s, time of the last heartbeat
    armed: bool
    in_air: bool
    ready: bool  # passes its own arming checks
    mode: str  # autopilot's mode, lower case: hold, offboard, land, ...
    failsafe: bool = False  # it reports that a failsafe of its own is active


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
    cycle: Cycle = NO_CYCLE  # of the previous tick
    flow: OpticalFlow | None = None
    range: Range | None = None
    ranges: tuple[AnchorRange, ...] = ()
    features: tuple[Features, ...] = ()
    external_pose: ExternalPose | None = None
    traffic: tuple[OtherVehicle, ...] = ()  # all other vehicles of the fleet
    in_control: bool = True  # no: a pilot commands, or the autopilot by itself
    problems: tuple[str, ...] = ()  # input that could not be used, and why; for the record
    gimbal: GimbalReading | None = None
    operator: OperatorReport | None = None  # the pilot at the page; None: there is no page
    utc: float | None = None  # s since 1970, of `now`; None: not known
