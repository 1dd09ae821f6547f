"""Base classes of plug-ins: parameters, a manual page, and one pure method.

A plug-in class is a frozen pydantic model. The name a mission file uses is the class variable
`kind`; the docstring is the manual page; fields carry units in their types. Nothing here reads
a clock, draws random numbers or does I/O, so that a flight replays bit for bit.

They are a convenience: what a plug-in must have stands in `missionkit.plugin_protocols`.
"""

from __future__ import annotations

import abc
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler
from pydantic_core import CoreSchema

from missionkit.messages import (
    BoxDetection,
    CameraModel,
    Estimate,
    Frame,
    Occupancy,
    Sighting,
    Spot,
    Step,
    Verdict,
)
from missionkit.messages.region import Region
from missionkit.plugin_protocols import Inputs, NamedInput, Prior

Place = tuple[float, float, float]
"""North, east, down (m)."""


class Plugin(BaseModel):
    """Parameters of something a mission file names with `use:`."""

    model_config = ConfigDict(
        frozen=True, defer_build=True, extra="forbid", strict=False, allow_inf_nan=False
    )

    kind: ClassVar[str]
    target_keys: ClassVar[tuple[str, ...]] = ("target", "of")
    """Names of parameters that name a target of the mission."""

    def text(self) -> str:
        """Return its parameters in words; "": as the mission file gives them."""
        return ""


@dataclass(frozen=True, slots=True)
class InFile:
    """Marks a parameter that a mission gives as the name of a YAML file beside it.

    The parameter's type is the model of what the file holds.
    """

    model: type[BaseModel]

    def __get_pydantic_json_schema__(
        self,
        schema: CoreSchema,
        handler: GetJsonSchemaHandler,
    ) -> dict[str, Any]:
        """Describe the name of the file."""
        return {"type": "string"}


@dataclass(frozen=True, slots=True)
class InGroup:
    """Marks a parameter that is a plug-in itself: `{use: kind, ...}`, or the bare kind.

    It has a default. Kinds in `named` stay text: the plug-in that has the parameter makes them.
    """

    group: str  # key of `PLUGIN_GROUPS`
    named: tuple[str, ...] = ()

    def __get_pydantic_json_schema__(
        self,
        schema: CoreSchema,
        handler: GetJsonSchemaHandler,
    ) -> dict[str, Any]:
        """Leave a mark, as references to plug-ins in a mission do; or `$name` of a parameter."""
        return {"anyOf": [{"x-plugin": self.group}, {"type": "string", "pattern": r"^\$"}]}


class Guard(Plugin):
    """A predicate over the estimate, answered with a verdict."""

    @abc.abstractmethod
    def check(self, seen: Estimate) -> Verdict:
        """Say whether the guard holds, with value, threshold and margin where it has them."""

    def region(self) -> Region | None:
        """Declare what the guard reads and where it holds; None: unknown."""
        return None


class WindowGuard(Plugin):
    """A predicate with memory, such as a sliding window. Its memory advances at every tick."""

    @abc.abstractmethod
    def begin(self) -> Any:
        """Return the memory at the start of the mission: an immutable value."""

    @abc.abstractmethod
    def advance(self, memory: Any, seen: Estimate) -> Any:
        """Return the next memory; called once per tick, evaluated or not."""

    @abc.abstractmethod
    def check(self, memory: Any, seen: Estimate) -> Verdict:
        """Say whether the guard holds, from the memory already advanced to this tick."""

    def resumed(self, memory: Any, gap: float) -> Any:  # noqa: ARG002
        """Return the memory after a `gap` (s) without commands and observations."""
        return memory

    def with_camera(self, camera: CameraModel) -> Self:  # noqa: ARG002
        """Return the guard as it flies with the mission's camera: here itself.

        Args:
            camera: lens and mount.
        """
        return self

    def region(self) -> Region | None:
        """Declare what the guard reads and where it holds; None: unknown."""
        return None


class CompositeGuard(Plugin):
    """A predicate over other guards, variables or states of the mission, beside the estimate.

    It may remember; what it remembers advances at every tick.
    """

    def named_inputs(self) -> tuple[NamedInput, ...]:
        """Return what it reads by name, to be checked when the mission is loaded."""
        return ()

    def begin(self) -> Any:
        """Return the memory at the start of the mission: an immutable value."""
        return None

    def advance(self, memory: Any, seen: Estimate) -> Any:  # noqa: ARG002
        """Return the next memory; called once per tick, evaluated or not."""
        return memory

    @abc.abstractmethod
    def check(self, memory: Any, seen: Estimate, inputs: Inputs) -> Verdict:
        """Say whether the guard holds, from the memory already advanced to this tick.

        Args:
            memory: as returned by `advance` at this tick.
            seen: the estimate at this tick.
            inputs: answers what `named_inputs` names: guards, variables, active states.
        """

    def resumed(self, memory: Any, gap: float) -> Any:  # noqa: ARG002
        """Return the memory after a `gap` (s) without commands and observations."""
        return memory

    def region(self) -> Region | None:
        """Declare what the guard reads and where it holds; None: unknown."""
        return None

    def sees(self) -> frozenset[str]:
        """Return the targets whose marker must be looked for, besides those of its region."""
        return frozenset()


class Behavior(Plugin):
    """The action of a state, with memory that lives as long as the state is active."""

    def begin(self, seen: Estimate) -> Any:  # noqa: ARG002
        """Return the memory on entry to the state: an immutable value."""
        return None

    @abc.abstractmethod
    def step(self, seen: Estimate, memory: Any) -> Step:
        """Say what to do now; the answer's `memory` comes back at the next tick."""

    def warm_up(self) -> None:
        """Compile or load, before take-off, what `step` would otherwise make a tick wait for."""

    def targets(self) -> tuple[str, ...]:
        """Name the targets this behaviour needs, for checks before flight."""
        return ()

    def with_camera(self, camera: CameraModel) -> Self:  # noqa: ARG002
        """Return the behaviour as it flies with the mission's camera: here itself.

        Args:
            camera: lens and mount.
        """
        return self

    @property
    def endless(self) -> bool:
        """Whether it is never done: something else must end it."""
        return False

    def explained(self, camera: CameraModel) -> str:  # noqa: ARG002
        """Return a sentence on what its parameters come to, for `explain`; "": nothing to add.

        Args:
            camera: lens and mount of the mission's camera.
        """
        return ""

    def way(self, start: Place, targets: Mapping[str, Place]) -> tuple[Place, ...]:  # noqa: ARG002
        """Return the places it flies to, in order, for checks before flight; empty: not known.

        Args:
            start: m, NED, where the state is entered.
            targets: m, NED, where the mission says the targets are.
        """
        return ()

    def unfit(self, known: Occupancy | None, targets: Mapping[str, Spot]) -> str:  # noqa: ARG002
        """Say before flight why the map rules this behaviour out; "" if it does not.

        Args:
            known: the map, if the mission has one.
            targets: where the targets are (m).
        """
        return ""


class Detector(Plugin):
    """Finds one target in camera frames. It has no memory: filter and guards do."""

    target: str

    @abc.abstractmethod
    def detect(self, frame: Frame, camera: CameraModel, prior: Prior) -> tuple[Sighting, ...]:
        """Return what a frame shows of the target; empty: it is not in view.

        Args:
            frame: an image (height, width) grey or (height, width, 3) BGR, or in a simulation
                that does not draw, the corners of the markers in view.
            camera: intrinsics (px) and mount on the body.
            prior: prior beliefs about vehicle and target, to choose between possible solutions.

        Returns:
            One sighting for each way the target can be seen as: its pose in the camera's frame
            (m), at the time of the frame, with finite standard deviations (m, rad) above zero.
        """


class BoxDetector(Plugin):
    """Finds all objects of a kind in camera frames. A tracker tells them apart."""

    @abc.abstractmethod
    def boxes(self, frame: Frame, camera: CameraModel, prior: Prior) -> tuple[BoxDetection, ...]:
        """Return the boxes around what a frame shows; empty: nothing is in view.

        Args:
            frame: an image (height, width) grey or (height, width, 3) BGR.
            camera: intrinsics (px) and mount on the body.
            prior: where the vehicle and the ground are thought to be, which says how large an
                object appears.

        Returns:
            One box for each object, its centre (px) in the image, its score from 0 to 1. Of more
            than 20 those with the highest scores count.
        """

    def warm_up(self) -> None:
        """Compile or load, before take-off, what `boxes` would otherwise make a tick wait for."""
