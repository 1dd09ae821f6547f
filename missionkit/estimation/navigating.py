"""What a navigator is: memory in, memory out, like a guard or a behaviour."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from missionkit.estimation.memory import NavState
from missionkit.geometry import Transform, Vec3
from missionkit.messages import Observation, Sighting


class Navigates(Protocol):
    """Turns what sensors said into where the vehicle is. Its memory is an immutable value."""

    def begin(self) -> Any:
        """Return the memory before the first observation."""

    def propagate(self, known: Any, observation: Observation) -> Any:
        """Return the memory after one observation."""

    def fuse(self, known: Any, sightings: tuple[Sighting, ...]) -> Any:
        """Return the memory after sightings of targets."""

    def pose_at(self, known: Any, at: float) -> Transform | None:
        """Return body to world at `at` (s), None where it is not known any more."""

    def read(self, known: Any) -> NavState:
        """Return what is believed now."""


class Navigation(Protocol):
    """The parameters of a navigator, as `navigation:` in a mission file gives them."""

    def build(self, surveyed: Mapping[str, tuple[Vec3, float]], mount: Transform) -> Navigates:
        """Return the navigator.

        Args:
            surveyed: where the mission file says each target is: (3,), m, NED, and its sd (m).
            mount: camera to body.
        """
