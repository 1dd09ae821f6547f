"""Parameters of a simulated free flyer: body, thrusters and sensors.

Every number can be overridden in a world file. The defaults are P3's, or those of its sensors.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from missionkit.sim.vehicle_parameters import ParameterModel, SensorRate
from missionkit.units import (
    Degrees,
    Fraction,
    Metres,
    MetresPerSecond2,
    Number,
    Point,
    RadiansPerSecond,
    Seconds,
)


class FreeFlyerBody(ParameterModel):
    """A cube with ten nozzles, five on its front and five on its back.

    The middle one of each face pushes inwards; the other four sit at the ends of an X and push
    along the face, across the arms of the X, in turn one way round and the other. Each nozzle
    only pushes, so at least seven are needed for six degrees of freedom. No jet leaves through
    the bottom, which carries the camera and docks. Limits: correction P3.5.
    """

    use: Literal["free_flyer"] = "free_flyer"
    mass: Number = Field(default=1.33, gt=0, description="kg")
    inertia: tuple[Number, Number, Number] = Field(
        default=(0.0022, 0.0022, 0.0022), description="kg m², principal, body axes"
    )
    size: Metres = Field(default=0.10, gt=0, description="side of the cube")
    force: Number = Field(default=0.1, gt=0, description="N, limit of each axis")
    torque: Number = Field(default=0.002, gt=0, description="N m, limit of each axis")
    nozzle_thrust: Number = Field(default=0.1, gt=0, description="N, of an open nozzle")
    nozzle_arm: Metres = Field(
        default=0.04, gt=0, description="of the X, from the middle of its face along each edge"
    )
    minimum_pulse: Seconds = Field(
        default=0.0005, description="a nozzle opens no shorter; less is saved up until it suffices"
    )
    allocation: Literal["linear_program", "pseudo_inverse"] = Field(
        default="linear_program", description="how nozzles share a wrench"
    )
    latency: Seconds = Field(default=0.01, description="of commands")
    patience: Seconds = Field(
        default=0.5, description="silence after which it stops thrusting and drifts"
    )
    power: Number = Field(default=4.0, ge=0, description="W, of its electronics")


class GyroModel(ParameterModel):
    """Rate gyroscope at 100 Hz; the defaults are the data sheet's of VectorNav's VN-100.

    A hundredth of a degree per second and root hertz is 1.7e-4 rad/s/√Hz: it has a third of that,
    and an in-run bias below 10 °/h.
    """

    noise: Number = Field(default=6.1e-5, ge=0, description="rad/s/√Hz")
    bias: RadiansPerSecond = Field(default=2.4e-5, ge=0, description="1 sigma at power-up")
    walk: Number = Field(default=0.0, ge=0, description="rad/s/√s, of the bias")


class AccelerometerModel(ParameterModel):
    """Accelerometer at the centre of mass, in the same unit as the gyroscope."""

    noise: Number = Field(default=1.4e-3, ge=0, description="m/s²/√Hz")
    bias: MetresPerSecond2 = Field(default=4e-4, ge=0, description="1 sigma at power-up")


class UwbModel(ParameterModel):
    """Ranges by ultra-wideband radio to the anchors in turn, in the order of the world file.

    An outlier came by a detour: it is longer by the size of a normal number of that deviation.
    """

    rate: SensorRate = Field(default=50.0, description="Hz, of all anchors together")
    sd: Metres = Field(default=0.02, ge=0, description="white")
    outliers: Fraction = Field(default=0.02, description="share of outliers")
    outlier_size: Metres = Field(default=0.5, ge=0, description="1 sigma of the detour")
    radio: Point = Field(default=(0.05, 0.05, 0.0), description="place on the body (m)")


class FlyerCamera(ParameterModel):
    """Camera that measures the feature points of the target's faces (P3, section III).

    They come while the target's centre is within `range` and `half_angle_deg` of the axis, of each
    face that is turned towards the camera. Camera axes are x right, y down, z forward; with no
    `attitude_deg` they are the body's, so that it looks out of the bottom.
    """

    rate: SensorRate = 20.0
    sd: Metres = Field(default=0.001, ge=0, description="of a point, each axis")
    half_angle_deg: Degrees = Field(default=35.0, gt=0, lt=90, description="of the cone of view")
    range: Metres = Field(default=0.8, gt=0, description="greatest distance")
    position: Point = Field(
        default=(0.0, 0.0, 0.04), description="on the body (m), a little behind its bottom face"
    )
    attitude_deg: tuple[Degrees, Degrees, Degrees] = Field(
        default=(0.0, 0.0, 0.0), description="camera axes to body, about x, then y, then z"
    )


class FlyerSensors(ParameterModel):
    """All sensors of a free flyer."""

    gyro: GyroModel = GyroModel()
    accelerometer: AccelerometerModel = AccelerometerModel()
    uwb: UwbModel = UwbModel()
    camera: FlyerCamera = FlyerCamera()
