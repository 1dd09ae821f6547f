"""The world that a free flyer docks in, as `worlds/*.yaml` describe it.

All places and attitudes are in the mother-ship's frame (x, y, z, m), which does not turn. Attitudes
are angles about x, then the new y, then the new z (`docking_geometry.turned`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar, Self

from pydantic import Field, model_validator

from missionkit.docking_geometry import NORMALS, Berth, Corridor, Face, berth_at, turned
from missionkit.geometry import Transform, vec
from missionkit.sim.fault_injection import FREE_FLYER_KINDS, Kind
from missionkit.sim.free_flyer.body_model import FlyerSensors, FreeFlyerBody
from missionkit.sim.vehicle_parameters import BatteryModel, ParameterModel
from missionkit.sim.world import Marker, Sphere
from missionkit.units import Degrees, DegreesPerSecond, Metres, MetresPerSecond, Point

Angles = tuple[Degrees, Degrees, Degrees]
Spot = tuple[Metres, Metres]
AnchorName = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
FEATURE_PATTERN: tuple[Spot, ...] = (
    *((0.035, 0.035), (0.035, -0.035), (-0.035, 0.035), (-0.035, -0.035)),
    *((0.02, 0.0), (0.0, -0.02)),
)


class DockingTarget(ParameterModel):
    """The cube that the chaser docks to; it keeps its place and attitude.

    Every face of `lit` carries the same `features`: places on it (m, from its middle), along x and
    y of a chaser that is docked there without roll. Those of the face top are top1, top2, …
    """

    name: str = "target"
    position: Point = (1.0, 2.0, 1.0)
    attitude_deg: Angles = (-90.0, 0.0, -90.0)
    size: Metres = Field(default=0.10, gt=0, description="side of the cube")
    face: Face = "top"
    roll_deg: Degrees = 0.0
    solid: bool = Field(default=True, description="false: it is flown through, nothing touches it")
    lit: tuple[Face, ...] = tuple(NORMALS)
    features: tuple[Spot, ...] = FEATURE_PATTERN

    @property
    def pose(self) -> Transform:
        """Body to mother-ship."""
        return Transform(turned(self.attitude_deg), vec(*self.position))


class FlyerStart(ParameterModel):
    """Where the chaser starts, at rest; a seed moves it by normal numbers of these deviations."""

    position: Point = (0.0, 1.0, 0.0)
    attitude_deg: Angles = (0.0, 0.0, 0.0)
    position_sd: Metres = Field(default=0.0, ge=0)
    attitude_sd_deg: Degrees = Field(default=0.0, ge=0)


class CorridorModel(ParameterModel):
    """A blunt cone before the docked place; only in it may the cubes come close."""

    radius: Metres = Field(default=0.03, gt=0, description="at the docked place")
    half_angle_deg: Degrees = Field(default=20.0, ge=0, lt=90)
    length: Metres = Field(default=0.30, gt=0, description="from the docked place")


class Capture(ParameterModel):
    """How close to the docked pose, and how slow, the docking mechanism takes hold."""

    position: Metres = Field(default=0.02, gt=0)
    attitude_deg: Degrees = Field(default=6.0, gt=0)
    speed: MetresPerSecond = Field(default=0.02, gt=0)
    rate_deg: DegreesPerSecond = Field(default=4.0, gt=0)
    contact_speed: MetresPerSecond = Field(
        default=0.05, gt=0, description="a faster touch is a crash"
    )


class FreeFlyerWorld(ParameterModel):
    """Everything the simulator of a free flyer needs beyond the mission file."""

    VEHICLE: ClassVar[str] = "a free flyer"
    FAULTS: ClassVar[Mapping[str, Kind]] = FREE_FLYER_KINDS

    world: str = Field(description="name")
    vehicle: FreeFlyerBody = Field(description="body and thrusters of the chaser")
    start: FlyerStart = FlyerStart()
    anchors: Mapping[AnchorName, Point] = {}
    target: DockingTarget = DockingTarget()
    corridor: CorridorModel = CorridorModel()
    capture: Capture = Capture()
    keep_out: Metres = Field(
        default=0.174, ge=0, description="around the target; outside the corridor stay farther away"
    )
    sensors: FlyerSensors = FlyerSensors()
    battery: BatteryModel = BatteryModel()

    @model_validator(mode="after")
    def _starts_clear(self) -> Self:
        gap = math.dist(self.start.position, self.target.position)
        least = max(self.keep_out, self.touching)
        if gap <= least:
            raise ValueError(
                f"the chaser starts {gap:g} m from the target, where {least:g} m are kept out"
            )
        return self

    @property
    def obstacles(self) -> tuple[Sphere, ...]:
        """The target, for pictures."""
        half = 0.5 * self.target.size
        return (Sphere(use="sphere", at=self.target.position, radius=half),)

    @property
    def markers(self) -> tuple[Marker, ...]:
        """None: the target carries features."""
        return ()

    @property
    def touching(self) -> float:
        """Distance (m) of the centres at which the cubes' bounding spheres touch."""
        return 0.5 * math.sqrt(3.0) * (self.vehicle.size + self.target.size)

    @property
    def berth(self) -> Berth:
        """Where the chaser docks."""
        it = self.target
        return berth_at(it.pose, it.face, it.roll_deg, it.size, self.vehicle.size)

    @property
    def cone(self) -> Corridor:
        """The docking corridor."""
        it = self.corridor
        slope = math.tan(math.radians(it.half_angle_deg))
        return Corridor(it.radius, slope, it.length, self.capture.position)
