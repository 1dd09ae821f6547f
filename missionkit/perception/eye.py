"""The eye: every frame of the camera becomes a look and sightings of targets."""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np

from missionkit.geometry import Transform, Vec3
from missionkit.messages import CameraModel, Detection, Frame, Look, Observation, Sighting, Target
from missionkit.perception.aruco import Aruco
from missionkit.perception.detector import Detector
from missionkit.perception.select import Candidate, area_of, plausible, select
from missionkit.perception.sighting import sight

SILENT_AFTER: Final = 1.5  # periods
_MOST_MISSED: Final = 100  # frames counted as missed in one tick


class Priors(NamedTuple):
    """What is believed before a frame is looked at."""

    body: Callable[[float], Transform | None]  # time (s) -> body to world
    targets: Mapping[str, Target]
    goal: Vec3 | None  # (3,), m, NED, of the mission


class EyeMemory(NamedTuple):
    """What the eye keeps from tick to tick."""

    heard_at: float | None = None  # s, when the last frame arrived or was given up
    asked_at: float | None = None  # s, of the last tick
    digest: int | None = None  # of the last frame's content


class Eye:
    """Looks for a mission's markers in the frames of one camera.

    Pure: the memory goes in and comes out, and what differs between two flights is in it. Every
    frame that was due yields one `Look`, so that the confidence window counts frames (P1 section
    1.3, NOTES P1.7): a camera that falls silent for 1.5 periods, or repeats an image to the bit,
    gives silent looks that saw nothing. A frame that arrives late is used at its own time.
    """

    def __init__(self, camera: CameraModel, markers: Sequence[Aruco]) -> None:
        self._camera = camera
        self._markers = {name: _of(markers, name) for name in {m.dictionary for m in markers}}
        longest = max(camera.width, camera.height)
        self._detectors = [Detector(name, longest) for name in sorted(self._markers)]

    def begin(self) -> EyeMemory:
        """Return the memory at the start of the mission."""
        return EyeMemory()

    def look(
        self, memory: EyeMemory, observation: Observation, priors: Priors
    ) -> tuple[EyeMemory, tuple[Look, ...], tuple[Sighting, ...]]:
        """Return the next memory, the looks due since the last tick, and one sighting a target."""
        frame, now = observation.frame, observation.now
        memory, missed = _missed(memory, now, self._camera.period, came=frame is not None)
        if frame is None:
            return memory, missed, ()
        digest = _digest(frame)
        following = EyeMemory(now, now, digest)
        if digest is not None and digest == memory.digest:
            return following, (*missed, Look(frame.at, frozenset(), silent=True)), ()
        sightings = self._sightings(frame, priors)
        seen = frozenset(s.target for s in sightings)
        return following, (*missed, Look(frame.at, seen)), sightings

    def _sightings(self, frame: Frame, priors: Priors) -> tuple[Sighting, ...]:
        detections = tuple(self._detections(frame))
        body = priors.body(frame.at) if detections else None
        found: dict[str, list[Candidate]] = {}
        for detection in detections:
            for marker in self._markers[detection.dictionary].get(detection.id, ()):
                prior = priors.targets.get(marker.target)
                if not marker.min_area <= detection.area <= marker.max_area:
                    continue
                candidate = sight(
                    detection, marker, self._camera, at=frame.at, body=body, prior=prior
                )
                if candidate is not None and plausible(candidate, prior):
                    found.setdefault(marker.target, []).append(candidate)
        return tuple(
            select(candidates, _expected(target, priors)).sighting
            for target, candidates in sorted(found.items())
        )

    def _detections(self, frame: Frame) -> Iterable[Detection]:
        """Return the known markers of a frame, whether it brings an image or ready corners."""
        for name, number, corners in frame.corners or ():
            if number in self._markers.get(name, {}):
                yield Detection(name, number, corners, area_of(corners))
        if frame.image is not None:
            for detector in self._detectors:
                yield from detector.detect(frame.image, self._markers[detector.name].keys())


def _missed(
    memory: EyeMemory, now: float, period: float, *, came: bool
) -> tuple[EyeMemory, tuple[Look, ...]]:
    """Give up the frames that should have come before this tick.

    While nothing comes they are those overdue by half a period. When a frame `came` after a gap,
    they are as many as fit in the gap, but only in that part of it in which we asked in vain: of
    several frames between two ticks only the last is seen, and the camera is not to blame.
    """
    if memory.heard_at is None or memory.asked_at is None:
        return memory._replace(heard_at=now, asked_at=now), ()
    heard, gap = memory.heard_at, (now - memory.heard_at) / period
    missed = math.floor(gap - SILENT_AFTER) + 1
    if came:
        missed = min(missed, round((memory.asked_at - heard) / period))
    missed = min(max(missed, 0), _MOST_MISSED)
    looks = tuple(Look(heard + i * period, frozenset(), silent=True) for i in range(1, missed + 1))
    return EyeMemory(heard + missed * period, now, memory.digest), looks


def _of(markers: Sequence[Aruco], dictionary: str) -> dict[int, tuple[Aruco, ...]]:
    """Return the markers of one dictionary by id; two targets may carry the same id."""
    own = [m for m in markers if m.dictionary == dictionary]
    return {i: tuple(m for m in own if m.id == i) for i in sorted({m.id for m in own})}


def _expected(target: str, priors: Priors) -> Vec3 | None:
    prior = priors.targets.get(target)
    return priors.goal if prior is None else prior.position


def _digest(frame: Frame) -> int | None:
    """Return a checksum of the content; None for corners that show nothing, which may repeat."""
    if frame.image is not None:
        return zlib.crc32(np.ascontiguousarray(frame.image).data)
    digest = 0
    for name, number, corners in frame.corners or ():
        digest = zlib.crc32(f"{name} {number} ".encode() + corners.tobytes(), digest)
    return digest if frame.corners else None
