"""Output of `missionkit camera check`."""

from __future__ import annotations

from collections.abc import Iterator
from statistics import median
from typing import NamedTuple

from missionkit.messages import Detection
from missionkit.perception.aruco import Aruco
from missionkit.perception.camera_section import Camera
from missionkit.perception.marker_check import Found
from missionkit.vehicle.camera.image_source import is_film
from missionkit.vehicle.camera.image_stream import TakenImage


class Subject(NamedTuple):
    """The camera and the markers to check."""

    source: int | str
    names: tuple[str, ...]  # dictionaries
    markers: tuple[Aruco, ...]
    camera: Camera | None  # of the mission


class ImageDetections(NamedTuple):
    """Detections in one image."""

    taken: TakenImage
    found: tuple[Found, ...]  # of the mission
    seen: tuple[Detection, ...]  # the same; without markers of a mission all there are
    took: float  # s


def timing(subject: Subject, looks: list[ImageDetections]) -> Iterator[str]:
    """Say how many images came, how fast, and how old they were if the driver stamps them."""
    camera, image = subject.camera, looks[-1].taken.image
    many = f"{len(looks)} image{'s' * (len(looks) > 1)} of {image.shape[1]}x{image.shape[0]}"
    spent = looks[-1].taken.at - looks[0].taken.at
    if spent > 0.0 and not is_film(subject.source):
        rate = (len(looks) - 1) / spent
        many += f", {rate:.1f} a second{'' if camera is None else f'; mission: {camera.rate:g}'}"
    yield many
    ages = [it.taken.age for it in looks if it.taken.age is not None]
    if ages:
        detail = (
            "" if camera is None else f"; latency of the mission: {1e3 * camera.latency:.0f} ms"
        )
        yield f"{1e3 * median(ages):.0f} ms old on arrival, by the driver's timestamps{detail}"
    elif camera is not None and not is_film(subject.source):
        latency = f"latency of the mission: {1e3 * camera.latency:.0f} ms"
        yield f"the driver does not report their age; {latency}"


def markers(subject: Subject, looks: list[ImageDetections]) -> Iterator[str]:
    """Say of each marker of the mission how often it was seen, and how far from the camera."""
    for marker in subject.markers:
        found = [it for look in looks for it in look.found if it.marker is marker]
        name = f"marker {marker.id} of {marker.target} ({marker.dictionary}, {marker.size:g} m)"
        yield f"{name}: {_told(found, len(looks))}"
    yield f"detection {1e3 * median(look.took for look in looks):.1f} ms"


def _told(found: list[Found], images: int) -> str:
    if not found:
        return "not seen"
    away = [it.distance for it in found if it.distance is not None]
    errors = [it.solution.error for it in found if it.solution is not None]
    detail = f"in {len(found)} of {images}"
    if away:
        spread = f" ± {(max(away) - min(away)) / 2:.3f}" if len(away) > 1 else ""
        detail += f", {median(away):.3f} m away{spread}"
        detail += f", corners fit to {median(errors):.2f} px"
    if any(it.upside_down for it in found):
        detail += (
            "; upside down in the image: is the camera mounted upside down? In flight it is not "
            "used"
        )
    if not all(it.counts for it in found):
        marker = found[0].marker
        detail += (
            f"; area outside {marker.min_area:g} to {marker.max_area:g} px²: it does not count"
        )
    return detail


def others(subject: Subject, ids: set[int]) -> Iterator[str]:
    """Name the markers that are not the mission's."""
    names = ", ".join(map(str, sorted(ids))) or "none"
    if ids or not subject.markers:
        yield f"{'other ' * bool(subject.markers)}markers in the picture: {names}"
