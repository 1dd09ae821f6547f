"""The memory of a flight between two ticks: immutable, and fit to be saved."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from missionkit.chart.semantics.chart_memory import ChartMemory
from missionkit.control.hold_point import HoldPoint
from missionkit.engine.target_tracks import TrackingMemory
from missionkit.geometry import Vec3
from missionkit.messages import (
    Battery,
    GimbalAim,
    GimbalReading,
    Goal,
    Range,
    Scan,
    VehicleStatus,
)
from missionkit.perception.vision_pipeline import VisionMemory
from missionkit.planning.scan_memory import FieldMemory


class SensorState(NamedTuple):
    """The latest sensor readings, and the memories of the filters."""

    navigation: Any  # the navigator's memory
    eye: VisionMemory
    battery: Battery | None = None
    status: VehicleStatus | None = None
    scan: Scan | None = None
    home: Vec3 | None = None
    range: Range | None = None
    misfit: str = ""  # how the sightings did not fit the filter's noise, the first time
    tracking: TrackingMemory | None = None  # None: nothing is tracked yet
    gimbal: GimbalReading | None = None


class PausedBehavior(NamedTuple):
    """A behaviour that does not command at present."""

    behavior: Any  # its memory
    done: bool
    goal: Goal | None


class BehaviorState(NamedTuple):
    """How far the commanding behaviour and the controller have come."""

    control: Any  # memory of the controller
    avoidance: Any = None  # memory of the planner
    behavior: Any = None
    begun: bool = False  # the behaviour's own memory exists
    done: bool = False
    goal: Goal | None = None
    failing: tuple[str, ...] = ()
    events: tuple[str, ...] = ()  # from the behaviour, to be handled at the next tick
    paused: Mapping[str, PausedBehavior] = {}  # states around the one that commands
    past: Mapping[str, PausedBehavior] = {}  # states that a history may lead back to
    scan: FieldMemory = FieldMemory()  # the newest, for braking
    held: HoldPoint | None = None  # the place that is held while no behaviour leads anywhere
    lands: bool = False  # the behaviour led to the ground on purpose at the last tick
    chosen: str | None = None  # the tracked target that the behaviour asked for at the last tick
    gimbal: GimbalAim | None = None  # aim of the gimbal, whichever behaviour gave it


class FlightMemory(NamedTuple):
    """All that a flight remembers from one tick to the next."""

    now: float
    senses: SensorState
    chart: ChartMemory
    acting: BehaviorState  # of the state that commands
    paused: bool = False  # by the operator


class FlightState(NamedTuple):
    """A flight in progress: everything that the shell around the tick needs to continue it."""

    memory: FlightMemory
    flown: bool = False  # it has been in the air
    grounded_since: float | None = None  # s, disarmed in a flying state
    aborting: bool = False
