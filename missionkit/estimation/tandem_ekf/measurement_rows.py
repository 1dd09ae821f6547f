"""Converts ranges and camera frames to rows for the kernels; what cannot be used is said."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from missionkit.errors import nearest
from missionkit.estimation.tandem_ekf.initialization import turned
from missionkit.estimation.tandem_ekf.parameters import FlyerEkf
from missionkit.estimation.tandem_ekf.state_layout import RANGE, ROW_WIDTH
from missionkit.geometry import Mat, Transform, vec
from missionkit.messages import AnchorRange, Features, Observation

Triple = tuple[float, float, float]
AHEAD = 0.05
"""Clocks may disagree by this much (s); a measurement from further in the future is refused."""
LARGEST = 1e6
"""No measurement is larger than this (m)."""


class MeasurementRows(NamedTuple):
    """Anchors and targets by name, with their places in the mother-ship's frame (m)."""

    names: Mapping[str, int]  # number of each source
    anchors: Mapping[str, Triple]
    targets: Mapping[str, Transform]
    features: Mapping[str, Mapping[str, Triple]]  # of each target

    @classmethod
    def of(cls, settings: FlyerEkf) -> MeasurementRows:
        """Return what the parameters give."""
        poses = {
            name: Transform(turned(it.attitude_deg), vec(*it.position))
            for name, it in settings.targets.items()
        }
        features = {
            name: {f: _triple(poses[name].apply(vec(*at))) for f, at in it.features.items()}
            for name, it in settings.targets.items()
        }
        sources = (*(f"anchor {a}" for a in settings.anchors), *settings.targets)
        numbers = {name: i for i, name in enumerate(sources)}
        return cls(numbers, dict(settings.anchors), poses, features)


class Taken(NamedTuple):
    """What one observation brought."""

    rows: Mat  # (n, 10), in order of time
    heard: tuple[float, ...]  # s, newest measurement of each source
    unusable: tuple[str, ...]  # measurements that mean nothing, and why
    late: int  # measurements that were overtaken by a newer one of the same source


class _Inbox:
    """Rows that grow while one observation is read."""

    def __init__(self, heard: tuple[float, ...], now: float) -> None:
        self.heard = list(heard)
        self.now = now
        self.rows: list[tuple[float, ...]] = []
        self.unusable: list[str] = []
        self.late = 0

    def punctual(self, source: int, at: float, what: str) -> bool:
        """Say whether a measurement's time is new and possible."""
        if not -math.inf < at <= self.now + AHEAD:
            self.unusable.append(f"{what} has the time {at:g} s, and now is {self.now:g} s")
            return False
        if at <= self.heard[source]:
            self.late += 1
            return False
        self.heard[source] = at
        return True


def rows_of(known: MeasurementRows, heard: tuple[float, ...], seen: Observation) -> Taken:
    """Return the rows of an observation.

    Args:
        known: anchors and targets.
        heard: s, newest measurement of each of them so far.
        seen: what was sensed.
    """
    inbox = _Inbox(heard, seen.now)
    for one in seen.ranges:
        _take_range(known, inbox, one)
    for number, frame in enumerate(seen.features):
        _take_frame(known, inbox, frame, float(number))
    inbox.rows.sort(key=lambda row: row[:2])
    rows = np.array(inbox.rows, dtype=np.float64).reshape(-1, ROW_WIDTH)
    return Taken(rows, tuple(inbox.heard), tuple(inbox.unusable), inbox.late)


def _take_range(known: MeasurementRows, inbox: _Inbox, one: AnchorRange) -> None:
    place = known.anchors.get(one.anchor)
    if place is None:
        hint = nearest(one.anchor, known.anchors)
        inbox.unusable.append(f"range to {one.anchor!r}, which is no anchor of navigation: {hint}")
    elif not 0.0 <= one.distance < LARGEST:
        inbox.unusable.append(f"range to {one.anchor} is {one.distance:g} m")
    elif inbox.punctual(known.names[f"anchor {one.anchor}"], one.at, f"range to {one.anchor}"):
        inbox.rows.append((one.at, RANGE, one.distance, 0.0, 0.0, *place, 0.0, 0.0))


def _take_frame(known: MeasurementRows, inbox: _Inbox, frame: Features, number: float) -> None:
    features = known.features.get(frame.target)
    if features is None:
        inbox.unusable.append(f"features of {frame.target!r}, which is no target of navigation")
        return
    points = frame.points.tolist()
    pairs = [(features.get(n), z) for n, z in zip(frame.names, points, strict=False)]
    usable = [(s, z) for s, z in pairs if s is not None and _possible(z)]
    if len(usable) < len(pairs) or len(pairs) != max(len(points), len(frame.names)):
        inbox.unusable.append(f"features of {frame.target} are unknown, or not finite numbers")
    if usable and inbox.punctual(known.names[frame.target], frame.at, f"frame of {frame.target}"):
        inbox.rows += [(frame.at, number, *z, *s, 0.0, 0.0) for s, z in usable]


def _possible(z: list[float]) -> bool:
    return len(z) == 3 and all(abs(c) < LARGEST for c in z)


def _triple(v: Mat) -> Triple:
    x, y, z = v.tolist()
    return x, y, z
