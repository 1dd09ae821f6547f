"""Parameters of the optical-flow navigator, as `navigation:` in a mission file gives them."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from missionkit.plugin import Plugin
from missionkit.units import Degrees, Fraction, Metres, Number, RadiansPerSecond, Seconds

Variance = Annotated[Number, Field(ge=0)]


class FlowKalman(Plugin):
    """A Kalman filter per axis over accelerometer and optical flow; no satellites, no camera.

    North, east and height each have a filter with state μ = (x, v), driven by the accelerometer.
    North and east are corrected by the optical flow's velocity, the height by range finder and
    barometer. Attitude, and with it gravity and the turn rate that is taken out of the flow, comes
    from a complementary filter of gyroscope, accelerometer and magnetometer. On the ground the
    velocity is zero. Position is dead reckoning from `start`: its error grows, and `position_sd`
    says how. Sightings of markers and satellite fixes are not used. The ground must be flat.
    Over MAVLink flow and range come from OPTICAL_FLOW_RAD or OPTICAL_FLOW, and DISTANCE_SENSOR.

        μ := A μ + B u,  Σ := A Σ Aᵀ + B σ² Bᵀ;   K = Σ Hᵀ (H Σ Hᵀ + R)⁻¹,  μ += K (z - H μ)

    Source: P2 section III-B with its variances (correction P2.3).
    Where the attitude comes from P2 does not say. With `bias_gain: 0` the gyroscope's bias is what
    it was found to be on the ground, as nothing in P2 corrects it.
    """

    kind: ClassVar[str] = "flow_kalman"
    vehicles: ClassVar[tuple[str, ...]] = ("sim",)

    start: tuple[Metres, Metres] = Field(default=(0.0, 0.0), description="on the map, north, east")
    accel_variance: tuple[Variance, Variance, Variance] = Field(
        default=(0.007868, 0.00871, 0.01), description="m²/s⁴, σ² north, east, up, of a tick"
    )
    flow_variance: tuple[Variance, Variance] = Field(
        default=(0.006017, 0.00995), description="m²/s², R north, east"
    )
    range_sd: Metres = Field(default=0.05, gt=0)
    baro_sd: Metres = Field(
        default=1.0, gt=0, description="more than the noise, for its offset drifts"
    )
    quality: Fraction = Field(default=0.3, description="flow below it is not used")

    tilt_gain: Number = Field(default=0.2, ge=0, description="1/s, towards the vertical and north")
    bias_gain: Number = Field(default=0.01, ge=0, description="1/s², of the gyroscope's bias")
    rate_bias_sd: RadiansPerSecond = Field(
        default=2e-4, ge=0, description="what is left of it; times height and time: position_sd"
    )
    declination_deg: Degrees = 0.0

    align_for: Seconds = Field(default=4.0, gt=0, description="at rest on the ground")
    max_gap: Seconds = Field(default=0.03, description="between two inertial samples")
    blind_after: Seconds = Field(
        default=3.0, description="diverged: no flow in the air, or no range any more"
    )
    silent_after: Seconds = Field(default=0.5, description="diverged: no inertial samples")
    max_position_sd: Metres = Field(default=20.0, gt=0, description="diverged: above it")
    axis_filter: Literal["numba", "filterpy"] = Field(
        default="numba", description="whose code filters an axis: ours, compiled, or filterpy's"
    )
