"""The camera of a vehicle on MAVLink: a real one, or the world drawn from the reported pose."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from missionkit.camera_pointing import camera_to_body
from missionkit.chart.model.mission import Mission
from missionkit.errors import FileError, Problem, UsageError
from missionkit.geometry import IDENTITY, Transform
from missionkit.messages import Frame
from missionkit.perception.camera_section import Camera as Section
from missionkit.perception.camera_section import numbered
from missionkit.sim.world import World
from missionkit.vehicle.camera.camera_device import CaptureSettings, Device, opened
from missionkit.vehicle.camera.frame_source import (
    FrameSource,
    NoCamera,
    Painter,
    Rendered,
)
from missionkit.vehicle.camera.image_source import found, is_film
from missionkit.vehicle.telemetry.reported_pose import Pose

AT_START = Pose(0.0, Transform(IDENTITY, np.zeros(3)), np.zeros(3), np.zeros(3))
RENDERED = "rendered"  # as the option: no device is opened, whatever the mission says


def camera_of(
    mission: Mission,
    folder: Path,
    world: World | None,
    *,
    seed: int = 0,
    speed: float = 1.0,
    source: int | str | None = None,
) -> FrameSource:
    """Return the camera a vehicle flies with.

    Args:
        mission: says which it is.
        folder: of the mission, which a relative file is looked for in.
        world: what a drawn camera sees.
        seed: of a drawn camera's noise.
        speed: seconds of the vehicle in one of the wall.
        source: another one than the mission's; a file is looked for in the working directory.

    Raises:
        FileError: the mission names a file that does not exist.
        UsageError: the option does, or there is no world to draw.
    """
    section = mission.camera
    if source == RENDERED:
        section = section.model_copy(update={"use": "rendered", "source": None})
    elif source is not None:
        return _device(section, named(source), speed)
    elif section.source is not None:
        return _device(section, source_of(mission, folder), speed)
    if section.use == "none":
        return NoCamera()
    if world is None:
        raise UsageError(
            "a rendered camera needs a world: name one in the mission, or give a camera source"
        )
    painter = painter_of(section, world, seed)
    painter(AT_START, AT_START.at)  # loads compiled code: the first frame must not be seconds late
    return Rendered(painter, section.rate, speed)


def source_of(mission: Mission, folder: Path) -> int | str:
    """Return the source of a mission's device.

    Raises:
        FileError: it is a file that does not exist.
        UsageError: the mission has no device.
    """
    source = mission.camera.source
    if source is None:
        raise UsageError(f"the camera of mission {mission.name!r} is not a device: give a SOURCE")
    try:
        return found(source, folder)
    except ValueError as error:
        message = f"camera source {source!r}: {error}"
        raise FileError([Problem(mission.place("camera"), message)]) from error


def named(source: int | str) -> int | str:
    """Return the source that the command line names; a file as the working directory has it.

    Raises:
        UsageError: it is a file that does not exist.
    """
    number = numbered(source)
    try:
        return found(number if isinstance(number, int) else str(source), Path())
    except ValueError as error:
        raise UsageError(f"camera {source}: {error}") from error


def _device(section: Section, source: int | str, speed: float) -> Device:
    period = 1.0 / (section.rate * speed) if is_film(source) else 0.0
    wanted = CaptureSettings(section.width, section.height, section.rate)
    return Device(lambda: opened(source), wanted, section.latency, period)


def painter_of(section: Section, world: World, seed: int = 0) -> Painter:
    """Return what draws the world as a camera sees it.

    Args:
        section: the mission's camera.
        world: what to draw.
        seed: of the image noise.
    """
    if world.deck is not None and world.deck.moves:
        raise UsageError(
            "the world has a deck that drives, which cannot be drawn over MAVLink: the "
            "simulator's time is not known there"
        )
    rng, model = np.random.default_rng(seed), section.model()
    exposure, nothing = section.exposure, frozenset[int]()
    from missionkit.sim.robot_look import looks_at  # noqa: PLC0415 (imports numba)

    if section.drawn:
        from missionkit.sim.camera_renderer import Renderer  # noqa: PLC0415 (imports cv2)

        renderer = Renderer(world, model, rng)

        def paint(pose: Pose, at: float) -> Frame:
            turned = pose.velocity, pose.rates
            robots = looks_at(world, pose.robots)
            mount = camera_to_body(model, pose.body.rotation, pose.gimbal)
            image = renderer.render(pose.body, *turned, exposure, nothing, robots, mount=mount)
            return Frame(at, image, gimbal=pose.gimbal)

        return paint
    from missionkit.sim.marker_visibility import Spotter  # noqa: PLC0415
    from missionkit.sim.obstacle_distance import table  # noqa: PLC0415 (compiles kernels)
    from missionkit.sim.robot_boxes import BoxSpotter  # noqa: PLC0415

    boxes = BoxSpotter(world, model, np.random.default_rng([seed, 1]))
    spotter = Spotter(world.all_markers, model, table(world), rng)

    def find(pose: Pose, at: float) -> Frame:
        body = pose.body
        x = np.concatenate((body.translation, pose.velocity, body.rotation, pose.rates))
        mount = camera_to_body(model, body.rotation, pose.gimbal)
        corners = spotter.find(x, exposure, nothing, mount=mount)
        seen = boxes.find(body, looks_at(world, pose.robots), mount) if pose.robots else ()
        return Frame(at, None, corners, seen, pose.gimbal)

    return find
