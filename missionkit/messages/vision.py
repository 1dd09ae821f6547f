"""Detections in camera frames."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from missionkit.geometry import Transform


@dataclass(frozen=True, slots=True)
class CameraModel:
    """A calibrated pinhole camera and where it sits on the body."""

    width: int
    height: int
    matrix: npt.NDArray[np.float64]  # (3, 3), px
    distortion: npt.NDArray[np.float64]  # (5,) k1 k2 p1 p2 k3
    mount: Transform  # camera to body FRD
    period: float  # s between frames
    gimbal_sd: float | None = None  # rad, how well its gimbal knows how it is turned; None: fixed


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
    """Targets found in one expected frame; a missing frame counts as one without targets."""

    at: float  # s
    seen: frozenset[str]  # names of the targets found
    silent: bool = False  # the frame was missing or a repetition


class BoxDetection(NamedTuple):
    """One object that a detector found in one frame, by the box around it."""

    detector: str
    centre: npt.NDArray[np.float64]  # (2,), px
    size: tuple[float, float]  # px, width and height
    score: float  # 0 to 1, how sure the detector is
    kind: str = ""  # of object, such as "robot"; "": the detector does not say
    id: int | None = None  # of this one object; None: the detector does not tell them apart
    sized: bool = True  # False: it was searched for at one size, which therefore says nothing


class GroundDetection(NamedTuple):
    """One object that a detector found in one frame, where it stands on level ground."""

    detector: str
    position: npt.NDArray[np.float64]  # (2,), m, north and east
    covariance: npt.NDArray[np.float64]  # (2, 2), m², of the pixels and of the vehicle's pose
    score: float  # 0 to 1
    size: float  # of its box, 1: that of a ground robot without a tower at this distance
    offset: float  # m, horizontally from the camera
    height: float  # m, of the camera above the ground
    kind: str = ""  # as of its box
    id: int | None = None
    sized: bool = True


class GroundFrame(NamedTuple):
    """What one frame shows on the ground."""

    at: float  # s, of the exposure
    detections: tuple[GroundDetection, ...]
    view: npt.NDArray[np.float64] | None = None  # (n, 2), m, corners of what it shows; None: all
    ground: float = 0.0  # m, down, of the ground
