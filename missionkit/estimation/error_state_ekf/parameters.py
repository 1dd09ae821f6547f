"""Parameters of the visual-inertial filter, as `navigation:` in a mission file gives them."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from missionkit.plugin import Plugin
from missionkit.units import Degrees, Fraction, Metres, MetresPerSecond, Number, Seconds


class VisualInertialEkf(Plugin):
    """Error-state EKF over position, velocity, attitude and inertial biases, and every target.

    Inertial samples carry the state forward; satellite fixes, barometer, magnetometer and
    sightings of the targets' markers correct it, and with `flow` also optical flow and range finder
    over flat ground, with `external_pose` also poses that motion capture measures, each at the
    time it was measured. A target begins where the mission file says and is corrected together
    with the vehicle; one that is `moving` is followed apart from it, with its velocity, and tells
    nothing about where the vehicle is. The defaults suit a consumer drone whose inertial unit gives
    100 samples a second.

        ẋ = (v, R(q) (a_m - b_a) + g, ½ q ⊗ (ω_m - b_g), 0, 0),   x += K (z - h(x))

    Source: P1 section 6.1; error state and reset as in Solà 2017; correction P1.6.
    """

    kind: ClassVar[str] = "visual_inertial_ekf"
    vehicles: ClassVar[tuple[str, ...]] = ("sim",)

    accel_noise: Number = Field(default=0.02, gt=0, description="m/s²/√Hz")
    gyro_noise: Number = Field(default=0.0015, gt=0, description="rad/s/√Hz")
    accel_bias_walk: Number = Field(default=3e-4, ge=0, description="m/s²/√s")
    gyro_bias_walk: Number = Field(default=2e-5, ge=0, description="rad/s/√s")
    accel_bias_sd: Number = Field(default=0.1, gt=0, description="m/s², at switch-on")
    target_walk: Number = Field(default=0.01, ge=0, description="m/√s, a target's own motion")
    moving: dict[str, MetresPerSecond] = Field(
        default={}, description="targets that move level, and how fast each may be at most"
    )
    moving_accel: Number = Field(default=0.3, gt=0, description="m/s²/√Hz, of those targets")
    target_turn_walk: Number = Field(default=0.01, gt=0, description="rad/√s")
    baro_sd: Metres = Field(
        default=1.0, gt=0, description="more than the noise, for its offset drifts"
    )
    mag_sd: Number = Field(
        default=0.1, gt=0, description="rad, heading; more than the noise, for hard iron stays"
    )
    fix_drift_sd: Metres = Field(
        default=0.5, ge=0, description="slow error that all fixes share; adds to absolute sds only"
    )
    bearing_sd: Number = Field(default=0.002, gt=0, description="rad, of the line to a marker")
    gnss: bool = Field(default=True, description="use satellite fixes")
    flow: bool = Field(default=False, description="use optical flow and range finder")
    flow_sd: Number = Field(default=0.045, gt=0, description="rad/s, of a sample")
    flow_quality: Fraction = Field(default=0.3, description="flow below it is not used")
    range_sd: Metres = Field(default=0.05, gt=0)
    external_pose: bool = Field(
        default=False, description="use poses measured from outside, such as motion capture"
    )
    declination_deg: Degrees = 0.0
    gate: Fraction = Field(default=0.9999, gt=0, lt=1, description="share of good data accepted")

    max_delay: Seconds = Field(default=0.5, description="older measurements are dropped")
    max_gap: Seconds = Field(default=0.03, description="between two inertial samples")
    longest_gap: Seconds = Field(
        default=0.5, description="after a longer one the filter aligns again, in the air too"
    )
    gap_accel: Number = Field(default=2.0, ge=0, description="m/s², unseen while samples miss")
    gap_rate: Number = Field(default=0.5, ge=0, description="rad/s, unseen while samples miss")

    align_for: Seconds = Field(default=2.0, gt=0, description="at rest on the ground")
    rest_accel: Number = Field(
        default=1.0, gt=0, description="m/s², above it the vehicle is not at rest"
    )
    rest_rate: Number = Field(
        default=0.05, gt=0, description="rad/s, above it the vehicle is not at rest"
    )
    origin_sd: Metres = Field(
        default=3.0, gt=0, description="of the take-off point where there is no fix"
    )

    blind_after: Seconds = Field(
        default=2.0, description="diverged: measurements arrive, but all are rejected"
    )
    stray_after: Seconds = Field(
        default=8.0, description="diverged: positions arrive, but all are rejected"
    )
    reset_after: Seconds = Field(
        default=5.0,
        description="consistent fixes rejected for so long: accepted if their velocities were "
        "rejected too or the vehicle stands disarmed, diverged otherwise (GNSS jumped)",
    )
    silent_after: Seconds = Field(default=0.5, description="diverged: no inertial samples")
    max_position_sd: Metres = Field(default=20.0, gt=0, description="diverged: above it")
    relocate_after: int = Field(
        default=10, ge=3, description="accept consistent sightings that were rejected this often"
    )
    reset_velocity_sd: MetresPerSecond = Field(default=5.0, gt=0)
    reset_angle_sd: Number = Field(default=0.1, gt=0, description="rad")
