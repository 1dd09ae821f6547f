"""A navigator of another package, kept from bringing a flight down.

While it fails, its last estimate is kept, marked as diverged: the failsafes of the estimate act.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from typing_extensions import override

from missionkit.errors import UsageError
from missionkit.estimation.navigator import Navigator, NavState
from missionkit.geometry import Transform
from missionkit.messages import Health, Observation, Sighting
from missionkit.plugin_containment import (
    Containment,
    PluginError,
    is_foreign,
    reporting_faults,
)

METHODS = ("begin", "propagate", "fuse", "pose_at", "read")
ARRAY_SHAPES = {"position": (3,), "velocity": (3,), "attitude": (4,), "rates": (3,)}


class ContainedMemory(NamedTuple):
    """Memory between ticks."""

    inner: Any  # memory of the navigator
    state: NavState  # the last that could be used


class ContainedNavigator(Navigator):
    """Calls a navigator so that nothing it raises or answers ends a flight.

    Args:
        name: of the plug-in, for messages.
        inner: the navigator.
        contain: keeps what went wrong.
    """

    def __init__(self, name: str, inner: Navigator, contain: Containment) -> None:
        self._name = name
        self._inner = inner
        self._contain = contain

    def within(self, contain: Containment) -> ContainedNavigator:
        """Return the same navigator for one tick, which keeps what goes wrong elsewhere."""
        return ContainedNavigator(self._name, self._inner, contain)

    @override
    def begin(self) -> ContainedMemory:
        inner = self._inner.begin()
        state = self._inner.read(inner)
        if wrong := fault_of(state):
            raise UsageError(f"navigator {self._name!r} cannot be used: it returned {wrong}")
        return ContainedMemory(inner, state)

    @override
    def propagate(self, known: ContainedMemory, observation: Observation) -> ContainedMemory:
        return self._advanced(known, "propagate", observation)

    @override
    def fuse(self, known: ContainedMemory, sightings: tuple[Sighting, ...]) -> ContainedMemory:
        return self._advanced(known, "fuse", sightings)

    @override
    def pose_at(self, known: ContainedMemory, at: float) -> Transform | None:
        boxed = self._contain.call(self._name, self._inner.pose_at, known.inner, at)
        pose: object = None if boxed is None else boxed[0]
        if pose is None:
            return None
        if isinstance(pose, Transform) and _fits(pose.rotation, (4,)):
            return pose if _fits(pose.translation, (3,)) else None
        self._contain.note(f"{self._name} returned from pose_at a {type(pose).__name__}")
        return None

    @override
    def read(self, known: ContainedMemory) -> NavState:
        return known.state

    def _advanced(self, known: ContainedMemory, method: str, *arguments: object) -> ContainedMemory:
        step = getattr(self._inner, method)
        boxed = self._contain.call(self._name, step, known.inner, *arguments)
        state = (
            None if boxed is None else self._contain.call(self._name, self._inner.read, boxed[0])
        )
        if boxed is None or state is None:
            return _lost(known)
        if wrong := fault_of(state[0]):
            self._contain.note(f"{self._name} returned {wrong}")
            return _lost(known)
        return ContainedMemory(boxed[0], state[0])


def contained(name: str, plugin: object, navigator: Navigator) -> Navigator:
    """Return a navigator that is fit to fly: one of another package in its containment.

    Args:
        name: for messages.
        plugin: parameters that built the navigator.
        navigator: to contain.

    Raises:
        UsageError: it lacks a method, or does not begin.
    """
    if not is_foreign(plugin):
        return navigator
    missing = [it for it in METHODS if not callable(getattr(navigator, it, None))]
    if missing:
        what = f"what it builds lacks {', '.join(missing)}"
        raise UsageError(f"navigator {name!r} cannot be used: {what}")
    safe = ContainedNavigator(name, navigator, Containment())
    try:
        with reporting_faults(UsageError):
            safe.begin()
    except PluginError as error:
        raise UsageError(f"navigator {name!r} cannot be used: begin raised {error}") from error
    return safe


def fault_of(state: object) -> str:
    """Say what makes a navigator's answer unusable; empty if nothing does."""
    if not isinstance(state, NavState):
        return f"{type(state).__name__}, expected a NavState"
    wrong = [name for name, shape in ARRAY_SHAPES.items() if not _fits(getattr(state, name), shape)]
    kinds: dict[str, type] = {"health": Health, "targets": dict}
    wrong += [name for name, kind in kinds.items() if not isinstance(getattr(state, name), kind)]
    return f"a NavState with {wrong[0]} of a wrong type or not finite" if wrong else ""


def _fits(value: object, shape: tuple[int, ...]) -> bool:
    return (
        isinstance(value, np.ndarray)
        and value.shape == shape
        and value.dtype.kind == "f"
        and bool(np.isfinite(value).all())
    )


def _lost(known: ContainedMemory) -> ContainedMemory:
    health = known.state.health._replace(diverged=True)
    return known._replace(state=known.state._replace(health=health))
