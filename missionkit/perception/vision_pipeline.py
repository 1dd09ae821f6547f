"""The eye: every frame becomes a look, sightings of targets, and objects on the ground."""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np

from missionkit.geometry import Transform, Vec3
from missionkit.messages import (
    CameraModel,
    FeatureMatches,
    FeatureSearch,
    Frame,
    GroundFrame,
    Look,
    Observation,
    Sighting,
)
from missionkit.perception import gimbal_view
from missionkit.perception.aruco import Aruco
from missionkit.perception.duplicate_markers import without_duplicates
from missionkit.perception.feature_matching import matched
from missionkit.perception.ground_search import ground_frame
from missionkit.perception.marker_search import MarkerSearch, Priors
from missionkit.perception.marker_selection import Candidate, plausible, select
from missionkit.perception.sighting_validation import fault_of
from missionkit.perception.upside_down import right_way_up
from missionkit.perception.vision_warning import VisionWarning, continued
from missionkit.plugin import Plugin
from missionkit.plugin_containment import Containment
from missionkit.plugin_protocols import BoxDetectorProtocol, DetectorProtocol, Prior

SILENT_AFTER: Final = 1.5  # periods
_MOST_MISSED: Final = 100  # frames counted as missed in one tick


class VisionMemory(NamedTuple):
    """Memory of the vision pipeline between ticks."""

    heard_at: float | None = None  # s, when the last frame arrived or was given up
    asked_at: float | None = None  # s, of the last tick
    digest: int | None = None  # of the last frame's content
    warnings: tuple[VisionWarning, ...] = ()


class Seen(NamedTuple):
    """What the vision pipeline saw since the last tick."""

    memory: VisionMemory
    looks: tuple[Look, ...]  # one for each frame that was due
    sightings: tuple[Sighting, ...]  # at most one of each target
    ground: GroundFrame | None  # objects on the ground; None: no new frame, or no detector of boxes


class VisionPipeline:
    """Looks for a mission's markers, and for objects on the ground, in the frames of one camera.

    Pure: the memory goes in and comes out, and what differs between two flights is in it. Every
    frame that was due yields one `Look`, so that the confidence window counts frames (P1 section
    1.3, correction P1.7): a camera that falls silent for 1.5 periods, or repeats an image exactly,
    gives silent looks that saw nothing; so does a frame of a gimbal whose attitude is not known. A
    frame that arrives late is used at its own time.

    Args:
        camera: intrinsics and mount.
        detectors: of any package. The built-in markers are found together, in one pass for each
            dictionary; any other detector is called alone, contained.
    """

    def __init__(self, camera: CameraModel, detectors: Sequence[Plugin]) -> None:
        self._camera = camera
        markers = [it for it in detectors if isinstance(it, Aruco)]
        self._search = MarkerSearch(camera, markers)
        self._others = [it for it in detectors if isinstance(it, DetectorProtocol)]
        self._boxes = [it for it in detectors if isinstance(it, BoxDetectorProtocol)]

    @property
    def finds_boxes(self) -> bool:
        """Some detector looks for objects on the ground."""
        return bool(self._boxes)

    def begin(self) -> VisionMemory:
        """Return the memory at the start of the mission."""
        return VisionMemory()

    def look(
        self,
        memory: VisionMemory,
        observation: Observation,
        priors: Priors,
        contain: Containment | None = None,
    ) -> Seen:
        """Return the next memory, and what was to be seen since the last tick.

        Args:
            memory: as the last tick left it.
            observation: with the frame that arrived, if one did.
            priors: prior beliefs about the targets.
            contain: keeps what went wrong in a detector.
        """
        frame, now = observation.frame, observation.now
        memory, missed = _missed(memory, now, self._camera.period, came=frame is not None)
        if frame is None:
            return Seen(memory, missed, (), None)
        digest = _digest(frame)
        following = memory._replace(heard_at=now, asked_at=now, digest=digest)
        if digest is not None and digest == memory.digest:
            silent = Look(frame.at, frozenset(), silent=True)
            return Seen(following, (*missed, silent), (), None)
        view = None
        if self._camera.gimbal_sd is not None:
            view = gimbal_view.gimbal_view(self._camera, frame, priors)
            if view is None:
                return _unusable(following, frame, missed)
            priors = view.priors
        eye = self._eye(frame.at, priors)
        markers, turned = right_way_up(
            self._search.find(frame, priors),
            self._search.upright,
            None if eye is None else eye.rotation,
        )
        contain = contain or Containment()
        others = tuple(self._found_by_others(frame, priors, contain))
        found = _plausible((*markers, *others), eye, priors)
        found, duplicates = without_duplicates(
            found, markers, self._search.declared, priors.targets
        )
        warnings = continued(memory.warnings, (*turned, *duplicates), frame.at)
        following = following._replace(warnings=warnings)
        sightings = tuple(
            select(candidates, _expected(target, priors)).sighting
            for target, candidates in sorted(found.items())
        )
        if view is not None:
            sightings = gimbal_view.on_fixed_mount(view, sightings)
        seen = frozenset(s.target for s in sightings)
        ground = ground_frame(self._boxes, self._camera, frame, priors, contain)
        return Seen(following, (*missed, Look(frame.at, seen)), sightings, ground)

    def match(
        self, frame: Frame, camera: CameraModel, search: FeatureSearch
    ) -> FeatureMatches | None:
        """Return which of a navigator's features a frame shows; None: it has no image.

        Args:
            frame: with its image.
            camera: lens and mount.
            search: where the navigator expects them.
        """
        if frame.image is None:
            return None
        return matched(frame.image, frame.at, camera, search)

    def _eye(self, at: float, priors: Priors) -> Transform | None:
        """Return camera to world at a time (s); None while the vehicle's own pose is unknown."""
        body = priors.body(at)
        return None if body is None else body @ self._camera.mount

    def _found_by_others(
        self, frame: Frame, priors: Priors, contain: Containment
    ) -> Iterator[Sighting]:
        """Yield what the detectors of other packages see; an answer that is unsound counts not."""
        for detector in self._others:
            prior = Prior(priors.body(frame.at), priors.targets.get(detector.target))
            boxed = contain.call(detector.kind, detector.detect, frame, self._camera, prior)
            if boxed is None:
                continue
            if wrong := fault_of(boxed[0], detector.target, frame.at):
                contain.note(f"{detector.kind} returned {wrong}")
                continue
            yield from boxed[0]


def _unusable(memory: VisionMemory, frame: Frame, missed: tuple[Look, ...]) -> Seen:
    """Return what is seen while it is not known where the camera of a gimbal looks: nothing.

    If that is the gimbal's fault, the frame counts as a missing one.
    """
    blind = frame.gimbal is None
    warned = (gimbal_view.unknown(frame.at),) if blind else ()
    memory = memory._replace(warnings=continued(memory.warnings, warned, frame.at))
    return Seen(memory, (*missed, Look(frame.at, frozenset(), silent=blind)), (), None)


def _plausible(
    sightings: Sequence[Sighting], eye: Transform | None, priors: Priors
) -> dict[str, list[Candidate]]:
    """Return by target the sightings that lie near enough to where it is believed to be."""
    found: dict[str, list[Candidate]] = {}
    for it in sightings:
        candidate = Candidate(it, None if eye is None else eye.apply(it.pose.translation))
        if plausible(candidate, priors.targets.get(it.target)):
            found.setdefault(it.target, []).append(candidate)
    return found


def _missed(
    memory: VisionMemory, now: float, period: float, *, came: bool
) -> tuple[VisionMemory, tuple[Look, ...]]:
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
    return memory._replace(heard_at=heard + missed * period, asked_at=now), looks


def _expected(target: str, priors: Priors) -> Vec3 | None:
    prior = priors.targets.get(target)
    return priors.goal if prior is None else prior.position


def _digest(frame: Frame) -> int | None:
    """Return a checksum of the content; None if nothing is in view, which may repeat."""
    if frame.image is not None:
        return zlib.crc32(np.ascontiguousarray(frame.image).data)
    digest = 0
    for name, number, corners in frame.corners or ():
        digest = zlib.crc32(f"{name} {number} ".encode() + corners.tobytes(), digest)
    for box in frame.boxes or ():
        digest = zlib.crc32(f"{box.detector} ".encode() + box.centre.tobytes(), digest)
    return digest if frame.corners or frame.boxes else None
