"""What a flight saw, kept beside it and shown again: a replay needs no images."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from missionkit.messages import (
    CameraModel,
    FeatureMatches,
    FeatureSearch,
    Frame,
    Observation,
)
from missionkit.perception.marker_search import Priors
from missionkit.perception.vision_pipeline import Seen, VisionMemory
from missionkit.plugin_containment import Containment


class Vision(Protocol):
    """What the tick asks of images; `VisionPipeline` answers it from the pixels."""

    @property
    def finds_boxes(self) -> bool:
        """Some detector looks for objects on the ground."""

    def begin(self) -> VisionMemory:
        """Return the memory at the start of the mission."""

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

    def match(
        self, frame: Frame, camera: CameraModel, search: FeatureSearch
    ) -> FeatureMatches | None:
        """Return which features a frame shows; None: it has no image.

        Args:
            frame: that arrived.
            camera: lens and mount.
            search: where the navigator expects its features.
        """


class ImageResult(NamedTuple):
    """What came of one image."""

    seen: Seen | None = None  # markers and objects
    matches: FeatureMatches | None = None  # features of the navigator


class RecordedVision:
    """Looks with another, and keeps what came of each image until it is taken.

    Args:
        inner: looks.
    """

    def __init__(self, inner: Vision) -> None:
        self._inner = inner
        self._last = ImageResult()

    @property
    def finds_boxes(self) -> bool:
        """Some detector looks for objects on the ground."""
        return self._inner.finds_boxes

    def begin(self) -> VisionMemory:
        """Return the memory at the start of the mission."""
        return self._inner.begin()

    def look(
        self,
        memory: VisionMemory,
        observation: Observation,
        priors: Priors,
        contain: Containment | None = None,
    ) -> Seen:
        """Look, and keep what an image showed.

        Args:
            memory: as the last tick left it.
            observation: with the frame that arrived, if one did.
            priors: prior beliefs about the targets.
            contain: keeps what went wrong in a detector.
        """
        seen = self._inner.look(memory, observation, priors, contain)
        if observation.frame is not None and observation.frame.image is not None:
            self._last = self._last._replace(seen=seen)
        return seen

    def match(
        self, frame: Frame, camera: CameraModel, search: FeatureSearch
    ) -> FeatureMatches | None:
        """Match features, and keep them.

        Args:
            frame: that arrived.
            camera: lens and mount.
            search: where the navigator expects its features.
        """
        matches = self._inner.match(frame, camera, search)
        self._last = self._last._replace(matches=matches)
        return matches

    def take(self) -> ImageResult | None:
        """Return what came of the image of this tick; None: there was none."""
        last, self._last = self._last, ImageResult()
        return None if last.seen is None and last.matches is None else last


class ReplayedVision:
    """Answers with what a flight saw; without an image at that tick it looks itself.

    Args:
        inner: of the mission that is replayed.
    """

    def __init__(self, inner: Vision) -> None:
        self._inner = inner
        self.shown: ImageResult | None = None  # at the tick under way

    @property
    def finds_boxes(self) -> bool:
        """Some detector looks for objects on the ground."""
        return self._inner.finds_boxes

    def begin(self) -> VisionMemory:
        """Return the memory at the start of the mission."""
        return self._inner.begin()

    def look(
        self,
        memory: VisionMemory,
        observation: Observation,
        priors: Priors,
        contain: Containment | None = None,
    ) -> Seen:
        """Return what the flight saw.

        Args:
            memory: as the last tick left it.
            observation: with the frame that arrived, if one did.
            priors: prior beliefs about the targets.
            contain: keeps what went wrong in a detector.
        """
        if self.shown is not None and self.shown.seen is not None:
            return self.shown.seen
        return self._inner.look(memory, observation, priors, contain)

    def match(
        self, frame: Frame, camera: CameraModel, search: FeatureSearch
    ) -> FeatureMatches | None:
        """Return what the flight matched.

        Args:
            frame: that arrived.
            camera: lens and mount.
            search: where the navigator expects its features.
        """
        if self.shown is not None:
            return self.shown.matches
        return self._inner.match(frame, camera, search)
