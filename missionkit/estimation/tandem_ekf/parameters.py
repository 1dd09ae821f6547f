"""Parameters of the free flyer's filters, as `navigation:` in a mission file gives them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from missionkit.plugin import Plugin
from missionkit.units import Degrees, Fraction, Metres, MetresPerSecond, Number, Point, Seconds

Angles = tuple[Degrees, Degrees, Degrees]
"""About x, then the new y, then the new z (deg): R_x R_y R_z."""
Name = Annotated[str, Field(min_length=1)]
ORIGIN: Point = (0.0, 0.0, 0.0)


class FeaturedTarget(BaseModel):
    """A target's pose in the mother-ship's frame, and its feature points in its own frame."""

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)

    position: Point
    attitude_deg: Angles = ORIGIN
    features: Mapping[Name, Point] = Field(min_length=1)


class FlyerEkf(Plugin):
    """Parameters shared by the filters of a free flyer."""

    vehicles: ClassVar[tuple[str, ...]] = ("free_flyer",)
    anchors: Mapping[Name, Point] = Field(
        min_length=3, description="radio anchors in the mother-ship's frame"
    )
    radio: Point = Field(default=ORIGIN, description="the vehicle's radio on its body, P_1")
    targets: Mapping[Name, FeaturedTarget] = Field(
        default={}, description="whose feature points the camera measures"
    )
    camera: Point = Field(default=ORIGIN, description="the camera on the body")
    camera_attitude_deg: Angles = Field(
        default=ORIGIN, description="camera axes (x right, y down, z forward) to body"
    )

    position: Point = Field(description="at the start, of the centre of mass")
    position_sd: Metres = Field(default=0.1, gt=0, description="each axis, at the start")
    velocity_sd: MetresPerSecond = Field(default=0.01, gt=0, description="at the start, about rest")
    attitude_deg: Angles = Field(default=ORIGIN, description="body axes at the start")
    attitude_sd_deg: Degrees = Field(default=1.0, gt=0, description="each axis, at the start")

    range_sd: Metres = Field(default=0.02, gt=0)
    feature_sd: Metres = Field(default=0.001, gt=0, description="of a feature point, each axis")
    accel_noise: Number = Field(
        default=0.003, gt=0, description="m/s²/√Hz, of the acceleration that is fed forward"
    )
    use_accel: bool = Field(
        default=True,
        description="feed the accelerometer forward; else accel_noise covers all thrust",
    )
    gyro_noise: Number = Field(default=6.1e-5, gt=0, description="rad/s/√Hz")

    gate: Fraction = Field(default=0.9999, gt=0, lt=1, description="share of good data accepted")
    underweight_above: Number = Field(
        default=1.0, ge=0, description="alpha: while tr H P Hᵀ exceeds so many tr R"
    )
    underweight: Number = Field(default=0.2, ge=0, description="beta: (1 + beta) H P Hᵀ in S")

    max_delay: Seconds = Field(default=0.2, description="older measurements are dropped")
    max_gap: Seconds = Field(default=0.03, description="between two inertial samples")
    gap_accel: Number = Field(default=0.1, ge=0, description="m/s², unseen while samples miss")
    gap_rate: Number = Field(default=0.1, ge=0, description="rad/s, unseen while samples miss")
    silent_after: Seconds = Field(default=0.5, description="diverged: no inertial samples")
    unplaced_after: Seconds = Field(
        default=3.0, description="without an accepted range or frame the position has no source"
    )
    max_position_sd: Metres = Field(default=1.0, gt=0, description="diverged: above it")

    @model_validator(mode="after")
    def _anchors_apart(self) -> Self:
        places = list(self.anchors.values())
        if len(set(places)) < len(places):
            names = [n for n, at in self.anchors.items() if places.count(at) > 1]
            raise ValueError(f"anchors {' and '.join(names)} are at the same place")
        return self


class TandemEkf(FlyerEkf):
    """Ranges, gyroscope and feature points of a free flyer, in two tandem Kalman filters.

    For a vehicle without weight near a mother-ship whose radio anchors are known; the world's frame
    is the mother-ship's. One filter has the radio's place and velocity (ρ_ij, ρ̇_ij), the other the
    attitude error δq = q ⊗ q̂⁻¹ about a quaternion; neither knows the other's covariance.
    Gyroscope and accelerometer carry both forward; ranges to `anchors` correct the first, feature
    points of `targets` both. A measurement outside its `gate` is refused; while the state is
    uncertain, measurements are underweighted. When most ranges, or most frames, are refused, the
    estimate has diverged and says so.

        ρ̈_ij = ρ̈ + ω̇ × p + ω × (ω × p),  p = D P_1;   q̇ = ½ q ⊗ ω_gyro
        S = (1 + β) H P Hᵀ + R while tr H P Hᵀ > α tr R,  else H P Hᵀ + R;   K = P Hᵀ S⁻¹

    Guards that ask for a fix see the last accepted range, those that ask for vision the last
    accepted frame. The gyroscope has to be free of bias, as P3 assumes: the filter has no state
    for one.

    Source: P3 sections II to IV; corrections P3.3 to P3.5; Markley 2003; Crassidis & Junkins 2011.
    """

    kind: ClassVar[str] = "tandem_ekf"


class CompoundEkf(FlyerEkf):
    """The filter of `tandem_ekf` with one covariance of all nine error states.

    It knows how the errors of place and attitude hang together, which the tandem filters leave
    out, and costs about twice as much. Parameters and equations are those of `tandem_ekf`.

    Source: P3 section IV, Table I.
    """

    kind: ClassVar[str] = "compound_ekf"
