"""An observer that keeps what a study needs of a flight."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from missionkit.geometry import norm, wrap, yaw_of
from missionkit.messages import Estimate, Observation, Record
from missionkit.perception.aruco import Aruco
from missionkit.rehearsal.stage import Stage
from missionkit.sim.ground_truth import TrueState
from missionkit.sim.world import Marker

EVERY = 10  # ticks between two samples of the estimate


class Change(NamedTuple):
    """One transition that was taken."""

    at: float  # s
    source: str
    to: str
    reason: str
    unseen: float | None  # s since the target's last sighting, None before the first


class Sample(NamedTuple):
    """Error of the estimate at one moment in the air."""

    state: str
    horizontal: float  # m
    vertical: float  # m
    heading: float  # rad
    sd: float  # m, what the filter believed: horizontal, along its worst direction
    relative: float | None  # m, of the vector to the target; None before it was seen
    relative_sd: float | None  # m, what the filter believed: one axis


class Watch:
    """An observer of one flight towards one target.

    Args:
        ready: the flight; its mission detects one marker at least.
    """

    def __init__(self, ready: Stage) -> None:
        self.changes: list[Change] = []
        self.problems: list[str] = []
        self.samples: list[Sample] = []
        self._ready = ready
        self._target, self.marker = _aim(ready)
        self._ticks = 0

    def __call__(self, record: Record, _: Observation) -> None:
        """Take in one tick."""
        self._ticks += 1
        seen = record.estimate
        for fired in record.fired:
            unseen = self._unseen(seen)
            self.changes.append(Change(record.now, fired.source, fired.to, fired.reason, unseen))
        self.problems += [f"{record.now:.2f} s: {problem}" for problem in record.problems]
        truth = self._ready.vehicle.truth
        if self._ticks % EVERY == 0 and seen.health.aligned and not truth.on_ground:
            self.samples.append(self._sample(record.state, seen, truth))

    def _unseen(self, seen: Estimate) -> float | None:
        at = seen.targets[self._target].seen_at
        return None if at is None else seen.now - at

    def _sample(self, state: str, seen: Estimate, truth: TrueState) -> Sample:
        error = seen.position - truth.position
        target, relative, relative_sd = seen.targets[self._target], None, None
        if target.seen_at is not None:
            off = target.position - np.array(self.marker.position)
            relative, relative_sd = norm(off - error), target.position_sd
        return Sample(
            state,
            float(np.hypot(error[0], error[1])),
            abs(float(error[2])),
            abs(wrap(seen.yaw - yaw_of(truth.attitude))),
            seen.health.position_sd,
            relative,
            relative_sd,
        )


def _aim(ready: Stage) -> tuple[str, Marker]:
    """Return the target's name and where its marker really hangs."""
    for use in ready.mission.perception:
        if isinstance(use.plugin, Aruco):
            marker = ready.world.marker(use.plugin.id, use.plugin.dictionary)
            if marker is not None:
                return use.plugin.target, marker
    raise ValueError(f"{ready.mission.name}: none of its markers hangs in {ready.world.world}")
