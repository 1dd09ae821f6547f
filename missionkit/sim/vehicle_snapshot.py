"""The state of a simulated vehicle as plain values, to be saved and put back.

`PARTS` says of each class which attributes change in flight. Everything else follows from world,
camera, seed and faults, with which the vehicle is rebuilt. Noise is saved as how much of each
stream was used. Left out: what arrived since the last observation (nothing, right after one), and
the last rendered picture, which only a frozen camera would show again.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any

import numpy as np

from missionkit.sim.autopilot_flight import AutopilotFlight
from missionkit.sim.camera_feed import Feed
from missionkit.sim.camera_renderer import Renderer
from missionkit.sim.flow_sensor import FlowSensor, RangeSensor
from missionkit.sim.free_flyer.feature_camera import FeatureCamera
from missionkit.sim.free_flyer.flyer_plant import FlyerPlant
from missionkit.sim.free_flyer.free_flyer import FreeFlyer
from missionkit.sim.gimbal import SimulatedGimbal
from missionkit.sim.herd_grading import HerdTrack
from missionkit.sim.lens_model import Sensor
from missionkit.sim.marker_visibility import Spotter
from missionkit.sim.plant import Plant
from missionkit.sim.random_blocks import Normals
from missionkit.sim.robot_boxes import BoxSpotter
from missionkit.sim.sensors import (
    BaroSensor,
    BatteryGauge,
    Beat,
    ExternalPoseSensor,
    GnssSensor,
    MagnetometerSensor,
)
from missionkit.sim.simulated_vehicle import SimulatedVehicle

Snapshot = Mapping[str, Any]

PARTS: Mapping[type, tuple[str, ...]] = {
    SimulatedVehicle: (
        *("payload", "_injected", "_plant", "_feed", "_gnss", "_baro", "_mag", "_gauge", "_scan"),
        *("_flow", "_range", "_outside", "devices", "photos", "_gimbal"),
        *("_heartbeat", "_ranges", "_link", "_fixes", "_orders", "_cycle", "_own"),
    ),
    FreeFlyer: (
        *("payload", "_injected", "_plant", "_camera", "_gauge", "_heartbeat", "_orders", "_cycle"),
    ),
    FlyerPlant: ("step", "state", "memory", "_imu", "_uwb"),
    FeatureCamera: ("beat", "_noise", "_last"),
    Plant: ("step", "state", "memory", "robots", "_wind", "_own", "_imu"),
    Feed: ("_spotter", "_boxes", "_renderer", "_waiting", "_count"),
    Spotter: ("_rng",),
    BoxSpotter: ("_rng",),
    Renderer: ("_sensor",),
    Sensor: ("_rng", "_gain"),
    GnssSensor: ("beat", "_noise", "_drift"),
    BaroSensor: ("beat", "_noise", "_drift", "_last"),
    MagnetometerSensor: ("beat", "_noise"),
    FlowSensor: ("beat", "_noise", "_lost", "_before", "_since"),
    RangeSensor: ("beat", "_noise"),
    ExternalPoseSensor: ("beat", "_noise", "_waiting"),
    BatteryGauge: ("beat", "sag"),
    Beat: ("_next",),
    SimulatedGimbal: ("_turning", "_rng"),
    AutopilotFlight: ("_home", "_return", "_precise", "_pad"),
}


def taken(vehicle: SimulatedVehicle | FreeFlyer) -> Snapshot:
    """Return the state of a vehicle that has just been observed, without its track."""
    state: Snapshot = _state(vehicle)
    return state


def restore(vehicle: SimulatedVehicle | FreeFlyer, state: Snapshot) -> None:
    """Put a new vehicle, of the same world, camera, seed and faults, into a saved state.

    The record of its ground robots begins there.
    """
    _put(vehicle, state)
    if isinstance(vehicle, SimulatedVehicle):
        vehicle.herd = HerdTrack()


def _state(value: Any) -> Any:
    names = PARTS.get(type(value))
    if names is not None:
        return {name: _state(getattr(value, name)) for name in names}
    match value:
        case Normals():
            return value.taken
        case np.random.Generator():
            return dict(value.bit_generator.state)
        case deque():
            return tuple(value)
        case np.ndarray():
            return value.copy()
        case _:
            return value


def _put(part: Any, state: Snapshot) -> None:
    for name in PARTS[type(part)]:
        now, kept = getattr(part, name), state[name]
        match now:
            case Normals():
                now.skip_to(kept)
            case np.random.Generator():
                now.bit_generator.state = kept
            case deque():
                setattr(part, name, deque(kept))
            case _ if type(now) in PARTS:
                _put(now, kept)
            case _:
                setattr(part, name, kept)
