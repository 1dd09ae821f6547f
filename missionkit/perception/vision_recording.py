"""What a flight saw, kept beside it and shown again: a replay needs no images."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from typing_extensions import override

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


class _OverVision(Vision):
    """Passes everything on to another."""

    def __init__(self, inner: Vision) -> None:
        self._inner = inner

    @property
    @override
    def finds_boxes(self) -> bool:
        return self._inner.finds_boxes

    @override
    def begin(self) -> VisionMemory:
        return self._inner.begin()

    @override
    def look(
        self,
        memory: VisionMemory,
        observation: Observation,
        priors: Priors,
        contain: Containment | None = None,
    ) -> Seen:
        return self._inner.look(memory, observation, priors, contain)

    @override
    def match(
        self, frame: Frame, camera: CameraModel, search: FeatureSearch
    ) -> FeatureMatches | None:
        return self._inner.match(frame, camera, search)


class RecordedVision(_OverVision):
    """Looks with another, and keeps what came of each image until it is taken.

    Args:
        inner: looks.
    """

    def __init__(self, inner: Vision) -> None:
        super().__init__(inner)
        self._last = ImageResult()

    @override
    def look(
        self,
        memory: VisionMemory,
        observation: Observation,
        priors: Priors,
        contain: Containment | None = None,
    ) -> Seen:
        seen = super().look(memory, observation, priors, contain)
        if observation.frame is not None and observation.frame.image is not None:
            self._last = self._last._replace(seen=seen)
        return seen

    @override
    def match(
        self, frame: Frame, camera: CameraModel, search: FeatureSearch
    ) -> FeatureMatches | None:
        matches = super().match(frame, camera, search)
        self._last = self._last._replace(matches=matches)
        return matches

    def take(self) -> ImageResult | None:
        """Return what came of the image of this tick; None: there was none."""
        last, self._last = self._last, ImageResult()
        return None if last.seen is None and last.matches is None else last


class ReplayedVision(_OverVision):
    """Answers with what a flight saw; without an image at that tick it looks itself.

    Args:
        inner: of the mission that is replayed.
    """

    def __init__(self, inner: Vision) -> None:
        super().__init__(inner)
        self.shown: ImageResult | None = None  # at the tick under way

    @override
    def look(
        self,
        memory: VisionMemory,
        observation: Observation,
        priors: Priors,
        contain: Containment | None = None,
    ) -> Seen:
        if self.shown is not None and self.shown.seen is not None:
            return self.shown.seen
        return super().look(memory, observation, priors, contain)

    @override
    def match(
        self, frame: Frame, camera: CameraModel, search: FeatureSearch
    ) -> FeatureMatches | None:
        if self.shown is not None:
            return self.shown.matches
        return super().match(frame, camera, search)
