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

    numbers: Mapping[tuple[str, str], int]  # of each source, by kind and name
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
        sources = [("range", a) for a in settings.anchors]
        sources += [("frame", name) for name in settings.targets]
        numbers = {source: i for i, source in enumerate(sources)}
        return cls(numbers, dict(settings.anchors), poses, features)


class Taken(NamedTuple):
    """Measurements of one observation."""

    rows: Mat  # (n, 10), in order of time
    heard: tuple[float, ...]  # s, newest measurement of each source
    unusable: tuple[str, ...]  # measurements that mean nothing, and why
    late: int  # measurements that were overtaken by a newer one of the same source


class _Inbox:
    """Rows that grow while one observation is read."""

    def __init__(
        self, numbers: Mapping[tuple[str, str], int], heard: tuple[float, ...], now: float
    ) -> None:
        self._numbers = numbers
        self.heard = list(heard)
        self.now = now
        self.rows: list[tuple[float, ...]] = []
        self.unusable: list[str] = []
        self.late = 0

    def punctual(self, kind: str, name: str, at: float) -> bool:
        """Say whether a measurement's time (s) is new and possible."""
        if not -math.inf < at <= self.now + AHEAD:
            self.unusable.append(f"{kind} of {name} has the time {at:g} s at {self.now:g} s")
            return False
        source = self._numbers[kind, name]
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
    inbox = _Inbox(known.numbers, heard, seen.now)
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
        inbox.unusable.append(
            f"range to {one.anchor!r}, which is not an anchor of navigation: {hint}"
        )
    elif not 0.0 <= one.distance < LARGEST:
        inbox.unusable.append(f"range to {one.anchor} is {one.distance:g} m")
    elif inbox.punctual("range", one.anchor, one.at):
        inbox.rows.append((one.at, RANGE, one.distance, 0.0, 0.0, *place, 0.0, 0.0))


def _take_frame(known: MeasurementRows, inbox: _Inbox, frame: Features, number: float) -> None:
    features = known.features.get(frame.target)
    if features is None:
        inbox.unusable.append(f"features of {frame.target!r}, which is not a target of navigation")
        return
    places = [features.get(name) for name in frame.names]
    fits = frame.points.shape == (len(places), 3) and None not in places
    if not (fits and bool((np.abs(frame.points) < LARGEST).all())):
        inbox.unusable.append(f"features of {frame.target} are unknown, or not finite numbers")
        return
    if places and inbox.punctual("frame", frame.target, frame.at):
        inbox.rows += [
            (frame.at, number, *z, *s, 0.0, 0.0)
            for s, z in zip(places, frame.points.tolist(), strict=True)
            if s is not None
        ]


def _triple(v: Mat) -> Triple:
    x, y, z = v.tolist()
    return x, y, z
