"""All that a flight remembers from one tick to the next: immutable, and fit to be saved."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from missionkit.chart.semantics.chart_memory import ChartMemory
from missionkit.control.controller import ControlMemory
from missionkit.control.holding import Held
from missionkit.geometry import Vec3
from missionkit.messages import Battery, Goal, Scan, VehicleStatus
from missionkit.perception.eye import EyeMemory
from missionkit.planning.potential_field import FieldMemory


class Senses(NamedTuple):
    """What was sensed last, and the filters' memories."""

    navigation: Any  # the navigator's memory
    eye: EyeMemory
    battery: Battery | None = None
    status: VehicleStatus | None = None
    scan: Scan | None = None
    home: Vec3 | None = None
    misfit: str = ""  # how the sightings did not fit the filter's noise, the first time


class Paused(NamedTuple):
    """A behaviour that does not command at present."""

    behavior: Any  # its memory
    done: bool
    goal: Goal | None


class Hands(NamedTuple):
    """Where behaviour and control stand."""

    control: ControlMemory
    avoidance: Any = None  # memory of the planner
    behavior: Any = None
    begun: bool = False  # the behaviour's own memory exists
    done: bool = False
    goal: Goal | None = None
    failing: tuple[str, ...] = ()
    events: tuple[str, ...] = ()  # from the behaviour, to be heard at the next tick
    paused: Mapping[str, Paused] = {}  # states around the one that commands
    past: Mapping[str, Paused] = {}  # states that a history may lead back to
    scan: FieldMemory = FieldMemory()  # the newest, for braking
    held: Held | None = None  # the place that is held while no behaviour leads anywhere


class Memory(NamedTuple):
    """The whole of it."""

    now: float
    senses: Senses
    chart: ChartMemory
    hands: Hands


class Course(NamedTuple):
    """A flight under way: all that the shell around the tick needs to go on with it."""

    memory: Memory
    flown: bool = False  # it has been in the air
    grounded_since: float | None = None  # s, disarmed in a flying state
    aborting: bool = False
