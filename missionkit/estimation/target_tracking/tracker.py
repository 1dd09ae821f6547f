"""Many targets in the frames of a camera: birth, confirmation, coasting and death of tracks.

Every frame, all tracks are carried to its exposure, detections are assigned to them, and what is
left over begins new tracks. A frame that arrives late is taken in at its own time: the tracker
goes back to before it and takes the later ones in again.

Source: P4 section III; S. Blackman, R. Popoli, "Design and Analysis of Modern Tracking Systems",
1999, chapter 6 (global nearest neighbour, score of a track).
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import ClassVar, NamedTuple

import numpy as np
from pydantic import Field

from missionkit.estimation.target_tracking import track
from missionkit.estimation.target_tracking.association import assigned, fused, usable
from missionkit.estimation.target_tracking.multiple_models import Estimator, Library
from missionkit.estimation.target_tracking.track import Motion, Track
from missionkit.estimation.target_tracking.track_output import target_of
from missionkit.geometry import Mat
from missionkit.ground_robot import GroundRobot
from missionkit.messages import GroundDetection, GroundFrame, Target, track_name
from missionkit.plugin import Plugin
from missionkit.units import Metres, Number, Seconds

WARM_UP_FRAMES = 8
REMEMBERED = 12
"""Frames that a late one can go back over."""


class Snapshot(NamedTuple):
    """The tracks after one frame."""

    at: float  # s, of the frame
    tracks: tuple[Track, ...]
    born: int  # tracks so far


class TrackerMemory(NamedTuple):
    """All the tracker knows; an immutable value."""

    now: Snapshot
    before: tuple[tuple[Snapshot, GroundFrame], ...] = ()  # the last frames, and before each
    refused: int = 0  # detections that were not sound
    late: int = 0  # frames that came too late


class MultiTargetTracker(Plugin):
    """Tracks up to 20 ground robots, each with its identity, mode of motion and class.

    A detection belongs to a track within the gate, Z = rᵀ S⁻¹ r (P4 (19)); all are assigned at
    once (global nearest neighbour). A track is confirmed once the scores of its detections sum up
    to `confirm_at`. Without detections it coasts, and ends `lost_after` in which it should have
    been seen, or when its position is less certain than `most_sd`.
    """

    kind: ClassVar[str] = "tracker"

    estimator: Estimator = Field(default="imm", description="models of motion")
    library: Library = Field(default="numba", description="whose code filters: ours or filterpy's")
    gate: Number = Field(default=13.8, gt=0, description="of Z; 13.8 is passed by 99.9 %")
    confirm_at: Number = Field(default=2.0, gt=0, description="scores of detections, summed up")
    lost_after: Seconds = Field(default=1.0, gt=0, description="in view, and not detected")
    most_sd: Metres = Field(default=1.0, gt=0, description="of a track that is kept")
    most_tracks: int = Field(default=20, ge=1, le=100, description="at once")

    def begin(self) -> TrackerMemory:
        """Return the memory before the first frame."""
        return _made(self).begin()

    def observe(self, memory: TrackerMemory, frame: GroundFrame) -> TrackerMemory:
        """Return the memory after one frame, which may be older than the last."""
        return _made(self).observe(memory, frame)

    def targets(self, memory: TrackerMemory, now: float) -> dict[str, Target]:
        """Return the confirmed tracks, where they are expected at `now` (s), by name."""
        return _made(self).targets(memory, now)

    def warm_up(self) -> None:
        """Compile or load what a frame would otherwise wait for."""
        seen = GroundDetection("", np.zeros(2), 1e-4 * np.eye(2), 1.0, 1.0, 0.0, 2.0)
        known = self.begin()
        for k in range(WARM_UP_FRAMES):
            ahead = seen._replace(position=np.array((0.33 * k, 0.0)))
            known = self.observe(known, GroundFrame(float(k), (ahead,)))
        self.targets(known, float(WARM_UP_FRAMES))


@lru_cache(maxsize=8)
def _made(settings: MultiTargetTracker) -> Tracker:
    return Tracker(settings, GroundRobot())


class Tracker:
    """Tracks targets by the parameters of a `MultiTargetTracker`. Pure: memory in, memory out.

    Args:
        settings: its parameters.
        robot: what it tracks.
    """

    def __init__(self, settings: MultiTargetTracker, robot: GroundRobot) -> None:
        self._settings = settings
        self.motion: Motion = track.motion(settings.estimator, robot, settings.library)

    def begin(self) -> TrackerMemory:
        """Return the memory before the first frame."""
        return TrackerMemory(Snapshot(-math.inf, (), 0))

    def observe(self, known: TrackerMemory, frame: GroundFrame) -> TrackerMemory:
        """Return the memory after one frame, which may be older than the last.

        Args:
            known: the memory.
            frame: what the camera found.
        """
        sound = tuple(usable(frame.detections))
        refused = known.refused + len(frame.detections) - len(sound)
        if not math.isfinite(frame.at):
            return known._replace(refused=known.refused + len(frame.detections))
        later = [it for it in known.before if it[1].at > frame.at]
        frames = [frame._replace(detections=sound), *(it for _, it in later)]
        start = later[0][0] if later else known.now
        if start.at > frame.at:
            return known._replace(late=known.late + 1)
        before = known.before[: len(known.before) - len(later)]
        for it in frames:
            before = (*before[1 - REMEMBERED :], (start, it))
            start = self._step(start, it)
        return TrackerMemory(start, before, refused, known.late)

    def targets(self, known: TrackerMemory, now: float) -> dict[str, Target]:
        """Return the confirmed tracks, where they are expected at `now`, by name.

        Args:
            known: the memory.
            now: s, later than the last frame, whose image took a while to arrive.
        """
        ahead = max(now - known.now.at, 0.0)
        ground = known.before[-1][1].ground if known.before else 0.0
        return {
            track_name(it.number): target_of(
                self.motion, it, track_name(it.number), max(now, known.now.at), ground
            )
            for it in (self._ahead(it, ahead) for it in known.now.tracks if it.confirmed)
            if _sd(it) <= self._settings.most_sd
        }

    def _ahead(self, it: Track, dt: float) -> Track:
        return track.predicted(self.motion, it, dt)

    def _step(self, last: Snapshot, frame: GroundFrame) -> Snapshot:
        dt = frame.at - last.at
        tracks = [track.predicted(self.motion, it, dt) for it in last.tracks]
        places = np.array([track.mean(it)[0][:2] for it in tracks]).reshape(-1, 2)
        reach = 0.5 * self.motion.robot.diameter
        found = fused(frame.detections, reach)
        pairs = assigned([it.state for it in tracks], found, self._settings.gate)
        kept: list[Track] = []
        for i, it in enumerate(tracks):
            if i in pairs:
                kept.append(track.updated(self.motion, it, frame.at, found[pairs[i]]))
            else:
                kept.append(track.missed(it, dt) if inside(places[i], frame.view) else it)
        kept = [self._confirmed(it) for it in kept if self._lives(it, frame.at)]
        over = [it for j, it in enumerate(found) if j not in pairs.values()]
        new = [it for it in over if not _near(it, places[list(pairs)], reach)]
        new = new[: self._settings.most_tracks - len(kept)]
        for number, seen in enumerate(new, last.born + 1):
            kept.append(self._confirmed(track.born(self.motion, number, frame.at, seen)))
        return Snapshot(frame.at, tuple(kept), last.born + len(new))

    def _confirmed(self, it: Track) -> Track:
        sure = it.confirmed or it.trust >= self._settings.confirm_at
        return it._replace(confirmed=sure)

    def _lives(self, it: Track, at: float) -> bool:
        """Say whether a track goes on: not if it should have been seen, or may be anywhere."""
        s = self._settings
        if not _sd(it) <= s.most_sd:
            return False
        if it.confirmed:
            return it.missed_for <= s.lost_after
        return it.looks & 0b11 != 0 and at - it.seen_at <= s.lost_after


def _sd(it: Track) -> float:
    """Return the larger standard deviation (m) of a track's place."""
    P = track.mean(it)[1]
    return math.sqrt(max(P[0, 0], P[1, 1]))


def _near(it: GroundDetection, places: Mat, reach: float) -> bool:
    """Say whether a detection is that of an object which has a track already."""
    return bool((np.hypot(*(places - it.position).T) < reach).any())


def inside(place: Mat, view: Mat | None) -> bool:
    """Say whether a place (2,) is within a convex polygon (n, 2); None: everywhere."""
    if view is None:
        return True
    edges, to_place = np.roll(view, -1, axis=0) - view, place - view
    sides = edges[:, 0] * to_place[:, 1] - edges[:, 1] * to_place[:, 0]
    return bool((sides >= 0.0).all() or (sides <= 0.0).all())
