"""Parameters of the vision-aided inertial navigator, as `navigation:` gives them."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from missionkit.plugin import Plugin
from missionkit.units import Degrees, Fraction, Metres, Number, Pixels, Seconds

Count = Annotated[int, Field(ge=4, le=40)]


class UdVisionEkf(Plugin):
    """Inertial navigation aided by features of level ground; no satellites, no markers.

    The state is attitude, position, velocity, the biases of accelerometer and gyroscope, and the
    position of every feature. Inertial samples carry it forward; a camera that sees the ground
    corrects it by the features found again, a range finder by the height, a magnetometer by the
    heading. Features are Harris corners of the image, each searched where it is expected. The
    covariance is held as U D Uᵀ (Bierman and Thornton), which single precision cannot spoil. On
    the ground the velocity is zero. The position counts from `start`: while the same features
    stay in view it does not drift, and with every one replaced `position_sd` grows. It needs images
    (`camera: {use: rendered}` or a device) of ground that is level and has a texture. Markers'
    sightings and satellite fixes are not used.

        x = (q, p, v, b_a, b_g, l_1 … l_N),   z = f (X/Z, Y/Z) of R_cb (R(q)ᵀ (l_i - p) - t)

    Source: P4 section II-B, (1) to (6) as mended; error state as in Solà 2017.
    """

    kind: ClassVar[str] = "ud_vision_ekf"
    vehicles: ClassVar[tuple[str, ...]] = ("sim",)
    images: ClassVar[bool] = True
    """It needs the camera's images."""

    start: tuple[Metres, Metres] = Field(default=(0.0, 0.0), description="on the map, north, east")
    features: Count = Field(default=20, description="states for as many")
    least_in_view: Count = Field(
        default=12, description="with fewer in view, those out of view are given up for new ones"
    )
    least_used: int = Field(default=4, ge=3, description="with fewer found, a frame says nothing")
    pixel_sd: Pixels = Field(default=0.3, gt=0, description="of a feature's place in the image")
    ground_sd: Metres = Field(default=0.05, gt=0, description="how far from level the ground is")
    prior_sd: Metres = Field(
        default=100.0, gt=0, description="of a new feature's place, before it is measured"
    )
    spacing: Pixels = Field(default=20.0, gt=0, description="between a new feature and the others")
    least_height: Metres = Field(default=0.3, gt=0, description="below it no feature is looked for")
    accel_noise: Number = Field(default=0.02, gt=0, description="m/s²/√Hz")
    gyro_noise: Number = Field(default=0.0015, gt=0, description="rad/s/√Hz")
    accel_bias_walk: Number = Field(default=1e-3, ge=0, description="m/s²/√s")
    gyro_bias_walk: Number = Field(default=3e-5, ge=0, description="rad/s/√s")
    accel_bias_sd: Number = Field(default=0.1, gt=0, description="m/s², at switch-on")
    range_sd: Metres = Field(default=0.05, gt=0)
    mag_sd: Number = Field(
        default=0.1, gt=0, description="rad, heading; more than the noise, for hard iron stays"
    )
    iron_sd: Number = Field(
        default=0.02,
        ge=0,
        description="rad, error of the heading that stays; times the way from the start it adds to "
        "position_sd",
    )
    declination_deg: Degrees = 0.0
    gate: Fraction = Field(default=0.999, gt=0, lt=1, description="share of good data accepted")
    precision: Literal["double", "single"] = Field(
        default="double", description="of the covariance's factors"
    )

    align_for: Seconds = Field(default=2.0, gt=0, description="at rest on the ground")
    max_delay: Seconds = Field(default=0.3, gt=0, description="older frames are dropped")
    max_gap: Seconds = Field(default=0.03, description="between two inertial samples")
    longest_gap: Seconds = Field(
        default=0.5, description="after a longer one velocity and features are forgotten"
    )
    blind_after: Seconds = Field(default=3.0, description="diverged: too few features in the air")
    silent_after: Seconds = Field(default=0.5, description="diverged: no inertial samples")
    max_position_sd: Metres = Field(default=5.0, gt=0, description="diverged: above it")
