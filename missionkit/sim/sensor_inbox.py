"""Sensor data that has arrived and has not been read."""

from __future__ import annotations

from dataclasses import dataclass, field

from missionkit.messages import (
    AnchorRange,
    Baro,
    Battery,
    Features,
    Frame,
    Gnss,
    Imu,
    Magnetometer,
    OpticalFlow,
    Range,
    Scan,
    VehicleStatus,
)


@dataclass(slots=True)
class Inbox:
    """Sensor data that has arrived since the last observation."""

    imu: list[Imu] = field(default_factory=list)
    gnss: Gnss | None = None
    baro: Baro | None = None
    mag: Magnetometer | None = None
    frame: Frame | None = None
    scan: Scan | None = None
    flow: OpticalFlow | None = None
    range: Range | None = None
    ranges: list[AnchorRange] = field(default_factory=list)
    features: list[Features] = field(default_factory=list)
    battery: Battery | None = None
    status: VehicleStatus | None = None
    events: list[str] = field(default_factory=list)
