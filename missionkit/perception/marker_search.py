"""Finding a mission's markers in a frame, those of one dictionary in one pass.

An image is looked at where a marker may be that would be believed; one in `WHOLE_EVERY` is looked
at as a whole, for the warnings of markers elsewhere.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final, NamedTuple

from missionkit.geometry import Transform, Vec3
from missionkit.messages import CameraModel, Detection, Frame, Sighting, Target
from missionkit.perception.aruco import Aruco
from missionkit.perception.ground_plane import ViewNoise
from missionkit.perception.marker_detector import MIN_PERIMETER, MarkerDetector
from missionkit.perception.marker_selection import area_of
from missionkit.perception.search_region import RegionFinder
from missionkit.perception.target_sighting import sight

WHOLE_EVERY: Final = 10  # frames


class Priors(NamedTuple):
    """Prior belief, before a frame is examined."""

    body: Callable[[float], Transform | None]  # time (s) -> body to world
    targets: Mapping[str, Target]
    goal: Vec3 | None  # (3,), m, NED, of the mission
    ground: float = 0.0  # m, down, of the level ground below
    noise: ViewNoise = ViewNoise()  # of what places a pixel on the ground


class MarkerSearch:
    """Looks for markers in frames.

    Args:
        camera: intrinsics and mount.
        markers: to be looked for.

    Attributes:
        declared: number of places in the mission with a marker of a dictionary and id.
        upright: markers that hang upright: dictionary, id and target.
    """

    def __init__(self, camera: CameraModel, markers: Sequence[Aruco]) -> None:
        self._camera = camera
        self._markers = {name: _of(markers, name) for name in {m.dictionary for m in markers}}
        places = {(m.dictionary, m.id, m.target, m.offset) for m in markers}
        self.declared = Counter((name, number) for name, number, *_ in places)
        self.upright = frozenset((m.dictionary, m.id, m.target) for m in markers if m.upright)
        longest = max(camera.width, camera.height)
        self._detectors = [MarkerDetector(name, longest) for name in sorted(self._markers)]
        self._regions = RegionFinder(camera, MIN_PERIMETER / 4.0)

    def find(self, frame: Frame, priors: Priors) -> Iterator[Sighting]:
        """Yield a sighting for each marker in view that has a pose.

        Args:
            frame: an image, or ready corners.
            priors: prior beliefs about the targets.
        """
        detections = tuple(self._detections(frame, priors))
        body = priors.body(frame.at) if detections else None
        for detection in detections:
            for marker in self._markers[detection.dictionary].get(detection.id, ()):
                if not marker.min_area <= detection.area <= marker.max_area:
                    continue
                prior = priors.targets.get(marker.target)
                seen = sight(detection, marker, self._camera, at=frame.at, body=body, prior=prior)
                if seen is not None:
                    yield seen.sighting

    def _detections(self, frame: Frame, priors: Priors) -> Iterator[Detection]:
        """Yield the known markers of a frame, whether it brings an image or ready corners."""
        for name, number, corners in frame.corners or ():
            if number in self._markers.get(name, {}):
                yield Detection(name, number, corners, area_of(corners))
        if frame.image is None:
            return
        whole = round(frame.at / self._camera.period) % WHOLE_EVERY == 0
        body = None if whole else priors.body(frame.at)
        for detector in self._detectors:
            wanted = self._markers[detector.name]
            believed = (
                (it, priors.targets.get(it.target)) for each in wanted.values() for it in each
            )
            region = self._regions.region(believed, body)
            if not region.empty:
                yield from detector.detect(frame.image, wanted.keys(), region)


def _of(markers: Sequence[Aruco], dictionary: str) -> dict[int, tuple[Aruco, ...]]:
    """Return the markers of one dictionary by id; two targets may carry the same id."""
    own = [m for m in markers if m.dictionary == dictionary]
    return {i: tuple(m for m in own if m.id == i) for i in sorted({m.id for m in own})}
