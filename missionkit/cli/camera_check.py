"""`missionkit camera check`: what a camera shows, and what a mission would see in it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import NamedTuple

from missionkit.api.missions import assemble
from missionkit.api.vehicle_camera import named, source_of
from missionkit.chart.load import load
from missionkit.chart.model.mission import Mission
from missionkit.cli.camera_report import (
    ImageDetections,
    Subject,
    markers,
    others,
    timing,
)
from missionkit.cli.overrides import overrides
from missionkit.errors import ExitCode, UsageError
from missionkit.perception.aruco import Aruco
from missionkit.perception.image_files import write
from missionkit.perception.marker_check import Checkup
from missionkit.perception.marker_dictionaries import known
from missionkit.vehicle.camera.camera_device import CaptureSettings, unfit
from missionkit.vehicle.camera.image_stream import images
from missionkit.vehicle.link.clocks import wall

DICTIONARY = "DICT_6X6_250"


class CheckOptions(NamedTuple):
    """The options of the command."""

    source: str | None
    mission: Path | None
    settings: Sequence[str]
    plugins: Sequence[Path]
    dictionary: str | None
    out: Path
    images: int


def check(request: CheckOptions) -> ExitCode:
    """Look at some images, draw what was found into one of them, and say it.

    Returns:
        Success, unless the mission has markers and none of them was seen.

    Raises:
        FileError: the mission cannot be used.
        UsageError: there is no source, or no image comes from it, or one of another size.
    """
    subject = _subject(request)
    looks, checkup = _looked(subject, request.images)
    shown = next((it for it in reversed(looks) if it.seen), looks[-1])
    if not write(request.out, checkup.drawn(shown.taken.image)):
        raise UsageError(
            f"{request.out}: could not write the picture; name a .png file in an existing folder"
        )
    strangers = {it.id for it in checkup.all(shown.taken.image)} - {m.id for m in subject.markers}
    lines = [*timing(subject, looks), *markers(subject, looks), *others(subject, strangers)]
    print("\n".join([*lines, f"wrote {request.out}"]))  # noqa: T201
    blind = bool(subject.markers) and not any(look.found for look in looks)
    return ExitCode.ENDED_SAFELY if blind else ExitCode.SUCCESS


def _subject(request: CheckOptions) -> Subject:
    mission = _mission(request)
    markers = () if mission is None else _of(mission, request.dictionary)
    names = {it.dictionary for it in markers} or {request.dictionary or DICTIONARY}
    try:
        names = {known(name) for name in names}
    except ValueError as error:
        raise UsageError(str(error)) from error
    camera = None if mission is None else mission.camera
    return Subject(_source(request, mission), tuple(sorted(names)), markers, camera)


def _mission(request: CheckOptions) -> Mission | None:
    if request.mission is None:
        return None
    return load(request.mission, assemble(request.plugins), overrides(request.settings))


def _source(request: CheckOptions, mission: Mission | None) -> int | str:
    if request.source is not None:
        return named(request.source)
    if mission is None or request.mission is None:
        raise UsageError("name a SOURCE: device number, file or URL; or a --mission with a device")
    return source_of(mission, request.mission.parent)


def _of(mission: Mission, dictionary: str | None) -> tuple[Aruco, ...]:
    markers = [it.plugin for it in mission.perception if isinstance(it.plugin, Aruco)]
    return tuple(it for it in markers if dictionary in {None, it.dictionary})


def _looked(subject: Subject, most: int) -> tuple[list[ImageDetections], Checkup]:
    camera = subject.camera
    wanted = None if camera is None else CaptureSettings(camera.width, camera.height, camera.rate)
    model = None if camera is None else camera.model()
    looks: list[ImageDetections] = []
    checkup = Checkup(subject.names)
    for taken in islice(images(subject.source, wanted), most):
        if wanted is not None and (wrong := unfit(taken.image, wanted)):
            raise UsageError(f"{subject.source}: {wrong}, which the mission is calibrated for")
        if not looks:
            longest = max(taken.image.shape[:2])
            checkup = Checkup(subject.names, subject.markers, model, longest)
        before = wall()
        found = checkup.look(taken.image)
        own = tuple(it.detection for it in found)
        seen = own if subject.markers else checkup.all(taken.image)
        looks.append(ImageDetections(taken, found, seen, wall() - before))
    return looks, checkup
