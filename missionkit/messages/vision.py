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
