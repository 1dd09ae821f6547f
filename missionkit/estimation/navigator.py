"""The interface of a navigator: memory in, memory out, like a guard or a behaviour."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, Protocol, runtime_checkable

from missionkit.geometry import Mat, Quat, Transform, Vec3
from missionkit.messages import (
    FeatureMatches,
    FeatureSearch,
    Health,
    Observation,
    Sighting,
    Target,
)


class NavState(NamedTuple):
    """State estimate of a navigator at the time of the newest inertial sample."""

    position: Vec3  # (3,), m, NED
    velocity: Vec3  # (3,), m/s, NED
    attitude: Quat  # (4,), body to world
    rates: Vec3  # (3,), rad/s, FRD, without bias
    health: Health
    targets: dict[str, Target]
    covariance: Mat  # (15, 15) of δp, δv, δθ (body, rad), δb_a, δb_g
    correction: Vec3  # (3,), m, NED: the sum of all resets of the position
    late: int  # measurements dropped because they came too late


class Navigator(Protocol):
    """Estimates the vehicle's state from sensor readings. Its memory is an immutable value."""

    def begin(self) -> Any:
        """Return the memory before the first observation."""

    def propagate(self, known: Any, observation: Observation) -> Any:
        """Return the memory after one observation."""

    def fuse(self, known: Any, sightings: tuple[Sighting, ...]) -> Any:
        """Return the memory after sightings of targets."""

    def pose_at(self, known: Any, at: float) -> Transform | None:
        """Return body to world at `at` (s), None where it is not known any more."""

    def read(self, known: Any) -> NavState:
        """Return the current estimate."""


@runtime_checkable
class FeatureNavigator(Navigator, Protocol):
    """A navigator that looks for features in images. The tick looks for them on its behalf."""

    def search(self, known: Any, at: float) -> FeatureSearch | None:
        """Return what to look for in the frame just observed, exposed at `at` (s); None: nothing.

        It is asked after `propagate`.
        """

    def see(self, known: Any, search: FeatureSearch, matches: FeatureMatches) -> Any:
        """Return the memory after what one frame shows.

        Args:
            known: as `search` saw it.
            search: what was looked for.
            matches: what was found.
        """


class NavigatorParameters(Protocol):
    """The parameters of a navigator, as `navigation:` in a mission file gives them."""

    def build(self, surveyed: Mapping[str, tuple[Vec3, float]], mount: Transform) -> Navigator:
        """Return the navigator.

        Args:
            surveyed: where the mission file says each target is: (3,), m, NED, and its sd (m).
            mount: camera to body.
        """
