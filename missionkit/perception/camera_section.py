"""The camera section of a mission file."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from missionkit.camera_pointing import looking
from missionkit.geometry import Mat, Transform
from missionkit.messages import CameraModel
from missionkit.units import Degrees, DegreesPerSecond, Hertz, Number, Pixels, Point, Seconds

FOCAL = 554.0  # px, about 60 deg across 640 px
DIGITS = 4  # of the number of a device


def numbered(source: object) -> object:
    """Return the number of a device where it is written as text: "0" is device 0.

    >>> numbered("0"), numbered("film.mp4")
    (0, 'film.mp4')
    """
    digits = isinstance(source, str) and source.isdecimal() and len(source) <= DIGITS
    return int(source) if digits else source  # type: ignore[call-overload]


Source = Annotated[
    Annotated[int, Field(ge=0, lt=10**DIGITS)] | Annotated[str, Field(min_length=1)],
    BeforeValidator(numbered),
]
Row = tuple[Pixels, Pixels, Pixels]
Focal = Annotated[Pixels, Field(ge=1, le=100_000)]
Side = Annotated[int, Field(ge=16, le=8192, json_schema_extra={"unit": "px"})]


class _Section(BaseModel):
    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)


class Mount(_Section):
    """Where the camera sits on the body (FRD, m), and how it is turned.

    It looks forward, `pan_deg` to the right and `tilt_deg` downwards, and is rolled clockwise about
    its optical axis by `roll_deg`, as seen from behind it (P4 (12), where that is the angle beta).
    """

    position: Point = (0.1, 0.0, 0.0)
    pan_deg: Annotated[Degrees, Field(ge=-180, le=180)] = 0.0
    tilt_deg: Annotated[Degrees, Field(ge=-90, le=90)] = 0.0
    roll_deg: Annotated[Degrees, Field(ge=-180, le=180)] = 0.0

    def transform(self) -> Transform:
        """Return camera to body FRD."""
        pan, tilt, roll = map(math.radians, (self.pan_deg, self.tilt_deg, self.roll_deg))
        return Transform(looking(tilt, pan, roll), np.array(self.position))


Span = tuple[Annotated[Degrees, Field(ge=-180)], Annotated[Degrees, Field(le=180)]]


class Gimbal(_Section):
    """A gimbal that turns the camera about its place on the body and keeps the picture level.

    The camera's `mount` is how it rests. `angle_sd_deg` is how well it knows how it is turned.
    """

    pitch_deg: Span = (-90.0, 30.0)
    yaw_deg: Span = (-90.0, 90.0)
    rate_deg: Annotated[DegreesPerSecond, Field(gt=0, le=720)] = 60.0
    angle_sd_deg: Annotated[Degrees, Field(ge=0, le=10)] = 0.1

    @model_validator(mode="after")
    def _spans_in_order(self) -> Self:
        for name, (low, high) in (("pitch_deg", self.pitch_deg), ("yaw_deg", self.yaw_deg)):
            if low >= high:
                raise ValueError(f"{name} is [least, most], got [{low:g}, {high:g}]")
        if self.pitch_deg[0] < -90.0 or self.pitch_deg[1] > 90.0:
            raise ValueError("pitch_deg lies within -90 (down) and 90 (up)")
        return self


class Camera(_Section):
    """A camera: how it sees, how often, how late, and where it is mounted.

    `use` says where its frames come from: `rendered` images, `corners` without an image (much
    faster, for campaigns), `none`, or the `source` of a real `device`: its number, a file or a
    URL. The simulator draws what a device would see. The lens is given either by `focal` in
    pixels (or `focal_x` and `focal_y`) and `centre`, or by the `matrix` of an OpenCV calibration:

        K = [f_x 0 c_x; 0 f_y c_y; 0 0 1]     distortion = [k1, k2, p1, p2, k3]
    """

    use: Literal["rendered", "corners", "none", "device"] = "rendered"
    source: Source | None = None
    width: Side = 640
    height: Side = 480
    focal: Focal | None = None
    focal_x: Focal | None = None
    focal_y: Focal | None = None
    centre: tuple[Pixels, Pixels] | None = None
    matrix: tuple[Row, Row, Row] | None = None
    distortion: tuple[Number, Number, Number, Number, Number] = (0.0, 0.0, 0.0, 0.0, 0.0)
    rate: Annotated[Hertz, Field(le=200)] = 20.0
    latency: Seconds = 0.06
    exposure: Seconds = 0.004
    mount: Mount = Mount()
    gimbal: Gimbal | None = None

    @property
    def drawn(self) -> bool:
        """Whether a simulator draws images: those of a device too, as its lens would see them."""
        return self.use in {"rendered", "device"}

    @model_validator(mode="after")
    def _source_of_a_device(self) -> Self:
        if self.use == "device" and self.source is None:
            raise ValueError("a device needs its source: a number, a file or a URL")
        if self.use != "device" and self.source is not None:
            raise ValueError("source belongs to use: device")
        return self

    @model_validator(mode="after")
    def _rests_within_its_gimbal(self) -> Self:
        if self.gimbal is None:
            return self
        if self.mount.roll_deg != 0.0:
            raise ValueError("a camera on a gimbal has no roll_deg: the gimbal keeps it level")
        for name, span, rest in (
            ("pitch_deg", self.gimbal.pitch_deg, -self.mount.tilt_deg),
            ("yaw_deg", self.gimbal.yaw_deg, self.mount.pan_deg),
        ):
            if not span[0] <= rest <= span[1]:
                raise ValueError(
                    f"the mount rests at {name} {rest:g}, outside the gimbal's "
                    f"{span[0]:g} to {span[1]:g}"
                )
        return self

    @model_validator(mode="after")
    def _one_lens(self) -> Self:
        pair = (self.focal_x, self.focal_y)
        if (self.focal_x is None) != (self.focal_y is None):
            raise ValueError("focal_x and focal_y belong together")
        if self.focal is not None and self.focal_x is not None:
            raise ValueError("give either focal, or focal_x and focal_y")
        if self.matrix is None:
            return self
        if any(value is not None for value in (self.focal, *pair, self.centre)):
            raise ValueError("the matrix already holds focal length and centre: give one of them")
        (fx, skew, _), (zero, fy, _), last = self.matrix
        if min(fx, fy) <= 0 or (skew, zero, *last) != (0.0, 0.0, 0.0, 0.0, 1.0):
            raise ValueError("the matrix must be [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], fx, fy > 0")
        return self

    def model(self) -> CameraModel:
        """Return the numbers that perception and the renderer work with."""
        return CameraModel(
            width=self.width,
            height=self.height,
            matrix=self._matrix(),
            distortion=np.array(self.distortion),
            mount=self.mount.transform(),
            period=1.0 / self.rate,
            gimbal_sd=None if self.gimbal is None else math.radians(self.gimbal.angle_sd_deg),
        )

    def _matrix(self) -> Mat:
        if self.matrix is not None:
            return np.array(self.matrix)
        both = self.focal or FOCAL
        fx, fy = self.focal_x or both, self.focal_y or both
        # The middle of the image: pixel centres have whole numbers, as in OpenCV.
        cx, cy = self.centre or (0.5 * (self.width - 1), 0.5 * (self.height - 1))
        return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
