"""Tracking in the tick: what frames show on the ground becomes targets of the estimate."""

from __future__ import annotations

import math
from collections.abc import Mapping
from numbers import Real
from typing import Any, NamedTuple

import numpy as np

from missionkit.geometry import Vec3
from missionkit.messages import TRACKED, GroundFrame, Look, Target, names_a_track
from missionkit.messages.robot_modes import OBSTACLE
from missionkit.plugin_containment import Containment, is_foreign
from missionkit.plugin_protocols import TrackerProtocol

NO_TARGETS: Mapping[str, Target] = {}


class TrackingMemory(NamedTuple):
    """What tracking remembers between ticks; an immutable value."""

    tracks: Any  # the tracker's memory
    chosen: str | None = None  # the target that `tracked` stands for, alive or lost


def begin_tracking(tracker: TrackerProtocol, contain: Containment) -> TrackingMemory | None:
    """Return the memory before the first frame, None while the tracker fails.

    Args:
        tracker: of the mission.
        contain: keeps what went wrong in the tracker.
    """
    boxed = contain.call(tracker.kind, tracker.begin, foreign=is_foreign(tracker))
    return None if boxed is None else TrackingMemory(boxed[0])


def observed(
    tracker: TrackerProtocol,
    known: TrackingMemory,
    frame: GroundFrame | None,
    contain: Containment,
) -> TrackingMemory:
    """Return the memory after what arrived since the last tick.

    Args:
        tracker: of the mission.
        known: the memory.
        frame: what the camera shows on the ground; None: no frame, or the eye's pose is unknown.
        contain: keeps what went wrong in the tracker.
    """
    if frame is None:
        return known
    boxed = contain.call(
        tracker.kind, tracker.observe, known.tracks, frame, foreign=is_foreign(tracker)
    )
    return known if boxed is None else known._replace(tracks=boxed[0])


def targets_at(
    tracker: TrackerProtocol, known: TrackingMemory, now: float, contain: Containment
) -> Mapping[str, Target]:
    """Return the targets where they are expected at `now` (s), by name; none if one is unsound.

    Args:
        tracker: of the mission.
        known: the memory.
        now: s.
        contain: keeps what went wrong in the tracker.
    """
    boxed = contain.call(
        tracker.kind, tracker.targets, known.tracks, now, foreign=is_foreign(tracker)
    )
    if boxed is None:
        return NO_TARGETS
    if wrong := fault_of(boxed[0]):
        contain.note(f"{tracker.kind} returned {wrong}")
        return NO_TARGETS
    return boxed[0]


def chosen(
    known: TrackingMemory, wanted: str | None, targets: Mapping[str, Target], here: Vec3
) -> TrackingMemory:
    """Return the memory with the target that `tracked` stands for.

    What a behaviour asks for is taken, then what was chosen before; if neither is tracked any
    more, the nearest that is likelier a target than an obstacle robot.

    Args:
        known: the memory.
        wanted: name of a target, by the behaviour that commands; None: any.
        targets: tracked now, by name.
        here: (3,), m, NED, of the vehicle.
    """
    for name in (wanted, known.chosen):
        if name in targets:
            return known._replace(chosen=name)
    near = [
        (math.dist(it.position[:2], here[:2]), name)
        for name, it in targets.items()
        if it.classes.get(OBSTACLE, 0.0) < 0.5
    ]
    return known._replace(chosen=min(near)[1]) if near else known


def with_chosen(targets: Mapping[str, Target], known: TrackingMemory) -> dict[str, Target]:
    """Return the targets with the chosen one under the name `tracked` too, if it is tracked."""
    it = targets.get(known.chosen or "")
    return dict(targets) if it is None else {**targets, TRACKED: it}


def with_detected(look: Look, targets: Mapping[str, Target]) -> Look:
    """Return a look with the tracked targets that its frame shows."""
    shown = frozenset(name for name, it in targets.items() if it.seen_at == look.at)
    return look._replace(seen=look.seen | shown) if shown else look


def fault_of(targets: object) -> str:
    """Say what makes a tracker's answer unusable; empty if nothing does."""
    if not isinstance(targets, Mapping):
        return f"{type(targets).__name__}, expected targets by name"
    for name, it in targets.items():
        if not (isinstance(name, str) and names_a_track(name) and name != TRACKED):
            return f"a target called {name!r}, expected 'robot_' and a number"
        if not (isinstance(it, Target) and it.name == name):
            return f"something else than the target {name!r} under that name"
        if not _is_finite(it):
            return f"{name!r} with a number that is not finite"
    return ""


def _is_finite(it: Target) -> bool:
    vectors = (it.position, *(() if it.velocity is None else (it.velocity,)))
    if any(np.shape(vector) != (3,) for vector in vectors):
        return False
    given = (it.position_sd, it.seen_at, it.heading, it.heading_sd, it.confidence, it.reversal_in)
    numbers = (number for number in given if number is not None)
    shares = (*it.modes.values(), *it.classes.values())
    return all(
        isinstance(n, Real) and math.isfinite(n)
        for n in (*np.ravel(vectors).tolist(), *numbers, *shares)
    )
