"""Parameters of the simulated vehicle: airframe, inner autopilot, sensors and battery.

Every number can be overridden in a world file. The defaults are those of a 1.6 kg research
quadrotor with consumer sensors.
"""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from missionkit.planning.rotor_power import RotorPower
from missionkit.units import (
    Degrees,
    Fraction,
    Hertz,
    Metres,
    MetresPerSecond,
    MetresPerSecond2,
    Number,
    RadiansPerSecond,
    Seconds,
)


class ParameterModel(BaseModel):
    """Base of every part of a world file: unknown keys are errors, values never change."""

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)


PHYSICS_RATE = 200  # Hz, physics and inner autopilot
SensorRate = Annotated[Hertz, Field(le=PHYSICS_RATE)]
Moment = Annotated[Number, Field(gt=0)]
FASTEST_AIR = 100.0  # m/s, past the vehicle: the strongest wind of a world


class Quadrotor(ParameterModel):
    """Rigid body with four rotors in X configuration.

    Drag is `-(drag_linear + drag_quadratic |v|) v` with v the velocity relative to the air. The
    battery gives `hover_power`, growing with each rotor's thrust^1.5 whatever the vehicle's motion;
    or, with `rotors`, what momentum and blade-element theory say of thrust and motion in the air.
    """

    mass: Number = Field(default=1.6, gt=0, description="kg")
    inertia: tuple[Moment, Moment, Moment] = Field(
        default=(0.018, 0.018, 0.032), description="kg m², principal, FRD"
    )
    arm: Metres = Field(default=0.25, gt=0, description="rotor axis to the centre")
    yaw_arm: Metres = Field(default=0.018, gt=0, description="rotor torque over rotor thrust")
    motor_lag: Seconds = Field(default=0.03, gt=0)
    thrust_to_weight: Number = Field(default=2.2, gt=1.2)
    drag_linear: Number = Field(default=0.25, ge=0, description="N/(m/s)")
    drag_quadratic: Number = Field(default=0.03, ge=0, description="N/(m/s)²")
    radius: Metres = Field(default=0.35, gt=0, description="of the sphere that must stay clear")
    hover_power: Number = Field(default=180.0, gt=0, description="W")
    rotors: RotorPower | None = Field(default=None, description="instead of hover_power")

    @model_validator(mode="after")
    def _one_power(self) -> Self:
        usual = type(self).model_fields["hover_power"].default
        if self.rotors is not None and self.hover_power != usual:
            raise ValueError("give either hover_power or rotors, whose own hover power follows")
        return self

    @model_validator(mode="after")
    def _heavy_enough(self) -> Self:
        drag = self.drag_linear + self.drag_quadratic * FASTEST_AIR
        if drag > PHYSICS_RATE * self.mass:  # it would be stopped within a step
            raise ValueError(
                f"a mass of {self.mass:g} kg is too small for this drag: at least "
                f"{drag / PHYSICS_RATE:.2g} kg, or less drag_linear and drag_quadratic"
            )
        return self

    @property
    def hovering(self) -> float:
        """Power (W) that a hover in still air takes."""
        return self.hover_power if self.rotors is None else self.rotors.hover(self.mass)


class InnerAutopilotModel(ParameterModel):
    """Gains and limits of the inner autopilot: velocity, attitude and rate loops.

    It knows its velocity up to a Gauss-Markov error, so it holds a velocity, not a position.
    """

    velocity_gain: Number = Field(default=2.2, gt=0, description="1/s")
    climb_gain: Number = Field(default=4.0, gt=0, description="1/s")
    integral_gain: Number = Field(default=0.8, ge=0, description="1/s²")
    integral_limit: MetresPerSecond2 = Field(default=3.0, ge=0, description="of that part")
    integral_zone: MetresPerSecond2 = Field(
        default=2.0, gt=0, description="it learns while the proportional part is below"
    )
    attitude_gain: Number = Field(default=7.0, gt=0, description="1/s")
    rate_gain: Number = Field(default=20.0, gt=0, description="1/s")
    acceleration: MetresPerSecond2 = Field(default=5.0, gt=0, description="horizontal limit")
    rate: RadiansPerSecond = Field(default=3.5, gt=0, description="roll and pitch rate limit")
    yaw_rate: RadiansPerSecond = Field(default=1.5, gt=0)
    climb: MetresPerSecond = Field(default=1.5, gt=0, description="during take-off")
    descent: MetresPerSecond = Field(default=0.7, gt=0, description="when landing")
    flare: MetresPerSecond = Field(default=0.35, gt=0, description="when landing, below 1.5 m")
    return_height: Metres = Field(default=15.0, ge=0, description="to rise to on its way home")
    patience: Seconds = Field(default=0.5, description="silence after which offboard turns to hold")
    velocity_sd: MetresPerSecond = Field(default=0.05, ge=0, description="of its own velocity")
    velocity_tau: Seconds = Field(default=5.0, gt=0, description="correlation time of that error")
    drift: Number = Field(default=0.02, ge=0, description="m/s/√s, of that error without GNSS")
    arming_charge: Fraction = Field(default=0.15, description="refuses to arm below")
    latency: tuple[Seconds, Seconds] = Field(default=(0.02, 0.04), description="of commands")


class ImuModel(ParameterModel):
    """100 Hz inertial unit: white noise, turn-on bias and bias random walk, per axis."""

    accel_noise: Number = Field(default=0.02, ge=0, description="m/s²/√Hz")
    gyro_noise: Number = Field(default=0.0015, ge=0, description="rad/s/√Hz")
    accel_bias: MetresPerSecond2 = Field(default=0.05, ge=0, description="1 sigma at power-up")
    gyro_bias: RadiansPerSecond = Field(default=0.003, ge=0, description="1 sigma at power-up")
    accel_walk: Number = Field(default=0.001, ge=0, description="m/s²/√s")
    gyro_walk: Number = Field(default=3e-5, ge=0, description="rad/s/√s")
    disarmed: Fraction = Field(default=1.0, description="share of the noise without turning rotors")


class GnssModel(ParameterModel):
    """Position: white noise plus a Gauss-Markov error, as multipath and the ionosphere give."""

    rate: SensorRate = 5.0
    latency: Seconds = 0.1
    horizontal_sd: Metres = Field(default=0.4, ge=0, description="white")
    vertical_sd: Metres = Field(default=0.7, ge=0, description="white")
    drift_sd: Metres = Field(default=0.5, ge=0, description="correlated, per axis")
    drift_tau: Seconds = Field(default=120.0, gt=0)
    velocity_sd: MetresPerSecond = Field(default=0.08, ge=0)


class BaroModel(ParameterModel):
    """Barometric height: zero at power-up, white noise plus slow drift with the weather."""

    rate: SensorRate = 10.0
    sd: Metres = Field(default=0.15, ge=0)
    drift_sd: Metres = Field(default=0.3, ge=0)
    drift_tau: Seconds = Field(default=300.0, gt=0)


class MagnetometerModel(ParameterModel):
    """Direction of the field, with declination 0 (north is magnetic north)."""

    rate: SensorRate = 10.0
    sd: Number = Field(default=0.02, ge=0, description="of the unit field")
    hard_iron: Number = Field(default=0.01, ge=0, description="1 sigma per axis, constant")
    inclination_deg: Degrees = Field(default=60.0, ge=-90, le=90)


class ScanModel(ParameterModel):
    """Levelled ring of range finders, 72 sectors of 5 degrees, the first one straight ahead."""

    rate: SensorRate = 10.0
    range: Metres = Field(default=12.0, gt=0)
    sd: Metres = Field(default=0.03, ge=0)


class FlowModel(ParameterModel):
    """Optical flow of flat ground, mean over the sampling interval, as a PX4Flow measures it.

    The noise is P2's, 0.006017 and 0.00995 m²/s² at 2 m. Its gyroscope is its own.
    """

    rate: SensorRate = 20.0
    sd: tuple[Number, Number] = Field(
        default=(0.0388, 0.0499), description="rad/s, of a sample, along the body's x and y"
    )
    scale: Number = Field(default=0.01, ge=0, description="1 sigma, of the focal length")
    gyro_sd: RadiansPerSecond = Field(default=0.003, ge=0, description="of a sample")
    gyro_bias: RadiansPerSecond = Field(default=0.003, ge=0, description="1 sigma at power-up")
    lost: Fraction = Field(default=0.02, lt=1, description="share of samples without texture")
    lost_for: Seconds = Field(default=0.2, gt=0, description="mean length of such a hole")
    least: Metres = Field(default=0.3, ge=0, description="blind below this distance")
    most: Metres = Field(default=10.0, gt=0, description="blind above this distance")
    fastest: RadiansPerSecond = Field(default=5.0, gt=0, description="blind above this flow")


class RangeModel(ParameterModel):
    """Range finder along the body's z, over flat ground."""

    rate: SensorRate = 20.0
    sd: Metres = Field(default=0.03, ge=0)
    least: Metres = Field(default=0.2, ge=0, description="nothing below this distance")
    most: Metres = Field(default=12.0, gt=0, description="nothing above this distance")


class ExternalPoseModel(ParameterModel):
    """Motion capture, or another system outside that measures the vehicle's pose: white noise."""

    rate: SensorRate = 20.0
    latency: Seconds = Field(default=0.02, le=0.4)
    position_sd: Metres = Field(default=0.002, ge=0, description="white, per axis")
    angle_sd: Number = Field(default=0.005, ge=0, description="rad, white, per axis")


class Sensors(ParameterModel):
    """All sensors except the camera, which the mission file describes."""

    imu: ImuModel = ImuModel()
    gnss: GnssModel = GnssModel()
    baro: BaroModel = BaroModel()
    magnetometer: MagnetometerModel = MagnetometerModel()
    scan: ScanModel = ScanModel()
    flow: FlowModel = FlowModel()
    range: RangeModel = RangeModel()
    external_pose: ExternalPoseModel | None = Field(
        default=None, description="none: no such system"
    )


class BatteryModel(ParameterModel):
    """Four lithium cells; the charge falls with the energy the rotors take."""

    capacity: Number = Field(default=22.5, gt=0, description="Wh")
    charge: Fraction = Field(default=1.0, description="at the start")
    resistance: Number = Field(default=0.03, ge=0, description="ohm")
