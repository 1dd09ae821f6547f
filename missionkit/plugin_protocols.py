"""Contracts of plug-ins: what a class must have to be used, whatever it is derived from.

The base classes in `missionkit.plugin` satisfy them and give the optional parts a default. The
contracts of navigators and planners are `estimation.navigator.NavigatorParameters` and
`planning.avoidance_planner.AvoidancePlanner`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, NamedTuple, Protocol, runtime_checkable

from missionkit.geometry import Transform
from missionkit.messages import (
    BoxDetection,
    CameraModel,
    Estimate,
    Frame,
    GroundFrame,
    Occupancy,
    Sighting,
    Spot,
    Step,
    Target,
    Verdict,
)
from missionkit.messages.herd import HerdChoice, HerdView
from missionkit.messages.region import Region


@runtime_checkable
class GuardProtocol(Protocol):
    """A predicate over the estimate; see `plugin.Guard`."""

    kind: ClassVar[str]

    def check(self, seen: Estimate) -> Verdict:
        """Say whether the guard holds."""

    def region(self) -> Region | None:
        """Declare what the guard reads and where it holds; None: unknown."""


@runtime_checkable
class WindowGuardProtocol(Protocol):
    """A predicate with memory; see `plugin.WindowGuard`."""

    kind: ClassVar[str]

    def begin(self) -> Any:
        """Return the memory at the start of the mission."""

    def advance(self, memory: Any, seen: Estimate) -> Any:
        """Return the next memory."""

    def check(self, memory: Any, seen: Estimate) -> Verdict:
        """Say whether the guard holds."""

    def resumed(self, memory: Any, gap: float) -> Any:
        """Return the memory after a `gap` (s)."""

    def region(self) -> Region | None:
        """Declare what the guard reads and where it holds; None: unknown."""


class NamedInput(NamedTuple):
    """Something of the mission that a guard reads, and where its parameters name it."""

    what: Literal["guard", "variable", "target", "state"]
    name: str
    path: tuple[str | int, ...] = ()


class Inputs(NamedTuple):
    """State of the rest of the mission at one tick, for a guard that reads it."""

    answers: Mapping[str, Verdict]  # of the guards that it names
    variables: Mapping[str, bool | int | float | str]  # all
    active: tuple[str, ...]  # states, outer ones first


@runtime_checkable
class CompositeGuardProtocol(Protocol):
    """A predicate over other parts of the mission too; see `plugin.CompositeGuard`."""

    kind: ClassVar[str]

    def named_inputs(self) -> tuple[NamedInput, ...]:
        """Return what it reads by name."""

    def begin(self) -> Any:
        """Return the memory at the start of the mission."""

    def advance(self, memory: Any, seen: Estimate) -> Any:
        """Return the next memory."""

    def check(self, memory: Any, seen: Estimate, inputs: Inputs) -> Verdict:
        """Say whether the guard holds.

        Args:
            memory: as returned by `advance` at this tick.
            seen: the estimate at this tick.
            inputs: answers what `named_inputs` names.
        """

    def resumed(self, memory: Any, gap: float) -> Any:
        """Return the memory after a `gap` (s)."""

    def region(self) -> Region | None:
        """Declare what the guard reads and where it holds; None: unknown."""

    def sees(self) -> frozenset[str]:
        """Return the targets whose marker must be looked for."""


@runtime_checkable
class BehaviorProtocol(Protocol):
    """The action of a state; see `plugin.Behavior`."""

    kind: ClassVar[str]

    def begin(self, seen: Estimate) -> Any:
        """Return the memory on entry to the state."""

    def step(self, seen: Estimate, memory: Any) -> Step:
        """Say what to do now."""

    def targets(self) -> tuple[str, ...]:
        """Name the targets this behaviour needs."""

    def unfit(self, known: Occupancy | None, targets: Mapping[str, Spot]) -> str:
        """Say before flight why the map rules this behaviour out; "" if it does not."""


class Prior(NamedTuple):
    """Prior belief about a target, before a frame is examined."""

    body: Transform | None  # body to world at the exposure; None: not known
    target: Target | None  # estimated position of the target; None: not known
    ground: float = 0.0  # m, down, of the level ground that things stand on


@runtime_checkable
class DetectorProtocol(Protocol):
    """Finds one target in camera frames; see `plugin.Detector`."""

    kind: ClassVar[str]

    @property
    def target(self) -> str:
        """Name of the target it looks for."""

    def detect(self, frame: Frame, camera: CameraModel, prior: Prior) -> tuple[Sighting, ...]:
        """Return what a frame shows of the target; empty: it is not in view.

        Args:
            frame: picture and the time of its exposure.
            camera: intrinsics and place on the body.
            prior: where vehicle and target are thought to be.
        """


@runtime_checkable
class BoxDetectorProtocol(Protocol):
    """Finds all objects of a kind in camera frames, by boxes; see `plugin.BoxDetector`."""

    kind: ClassVar[str]

    def boxes(self, frame: Frame, camera: CameraModel, prior: Prior) -> tuple[BoxDetection, ...]:
        """Return the boxes around what a frame shows; empty: nothing is in view.

        Args:
            frame: picture and the time of its exposure.
            camera: intrinsics and place on the body.
            prior: where the vehicle and the ground below it are thought to be.
        """


@runtime_checkable
class HerdingPolicyProtocol(Protocol):
    """Says which ground robot to turn next, and how."""

    kind: ClassVar[str]

    def choose(self, view: HerdView) -> HerdChoice:
        """Return the robot that is next, what to do with it, and the value of each robot.

        Args:
            view: what is known of the arena.
        """


@runtime_checkable
class TrackerProtocol(Protocol):
    """Tracks moving targets on the ground; its memory is an immutable value."""

    kind: ClassVar[str]

    def begin(self) -> Any:
        """Return the memory before the first frame."""

    def observe(self, memory: Any, frame: GroundFrame) -> Any:
        """Return the memory after one frame, which may be older than the last."""

    def targets(self, memory: Any, now: float) -> Mapping[str, Target]:
        """Return each target where it is expected at `now` (s), by name: `track_name` of a number.

        A number stays with its target, and never comes back for another.
        """
