"""Pictures of ground robots from above, at random, with what is in them: for training and tests."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import cv2
import numpy as np

from missionkit.geometry import Mat, Transform, from_euler, vec
from missionkit.messages import CameraModel, Image
from missionkit.perception.camera_section import Camera, Mount
from missionkit.perception.square_pose import project
from missionkit.sim.camera_renderer import Renderer
from missionkit.sim.robot_look import ROBOT, RobotLook
from missionkit.sim.textures import grey
from missionkit.sim.world import Ground, World

CLEAR = 0.36  # m between the middles of two robots
AROUND = 9.0  # m from the world's middle, where the camera is

Range = tuple[float, float]


class Domain(NamedTuple):
    """From what pictures are drawn: each number uniformly from a range."""

    worlds: tuple[World, ...]
    plates: Range = (60.0, 225.0)  # grey levels
    light: Range = (0.6, 1.35)  # brightness, times the simulator's
    shadow: Range = (0.55, 0.9)  # brightness inside a shadow's edge
    shadows: float = 0.5  # share of pictures with such an edge
    blur: Range = (0.0, 0.9)  # px, sd, beside the simulated lens's
    exposure: Range = (0.002, 0.008)  # s
    speed: float = 1.5  # m/s, sd of the vehicle's
    height: Range = (1.2, 3.3)  # m, of the camera
    tilt: float = 0.07  # rad, sd about each axis
    focal: Range = (240.0, 320.0)  # px
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    robots: int = 6  # placed at most about a picture
    towers: float = 0.15  # share of robots that are obstacle robots


class RobotView(NamedTuple):
    """One picture, and where in it the robots are."""

    image: Image
    camera: CameraModel
    body: Transform
    robots: tuple[RobotLook, ...]
    places: Mat  # (n, 2), px, of the middle of each robot's top


def floors(names: Sequence[str]) -> tuple[World, ...]:
    """Return empty worlds with these ground textures."""
    return tuple(
        World(world=name, ground=Ground.model_validate({"texture": name})) for name in names
    )


def robot_views(domain: Domain, count: int, seed: int) -> Iterator[RobotView]:
    """Yield pictures, floor by floor: a floor's textures take a second to prepare.

    Args:
        domain: what they differ in.
        count: of pictures.
        seed: of all chance.
    """
    rng = np.random.default_rng(seed)
    shown: World | None = None
    renderers: dict[float, Renderer] = {}  # of one floor, by focal length: they have a memory
    for number in range(count):
        world = domain.worlds[number * len(domain.worlds) // count]
        if world is not shown:
            shown = world
            renderers.clear()
        yield _view(domain, world, rng, renderers)


def _view(
    domain: Domain, world: World, rng: np.random.Generator, renderers: dict[float, Renderer]
) -> RobotView:
    camera = _camera(round(rng.uniform(*domain.focal), -1), domain.distortion)
    north, east = rng.uniform(-AROUND, AROUND, 2) + np.array(world.middle)
    height = rng.uniform(*domain.height)
    roll, pitch = rng.normal(0.0, domain.tilt, 2).tolist()
    turn = from_euler(roll, pitch, rng.uniform(-math.pi, math.pi))
    body = Transform(turn, vec(north, east, -height))
    robots = _robots(domain, body, rng)
    focal = float(camera.matrix[0, 0])
    if focal not in renderers:
        renderers[focal] = Renderer(world, camera, np.random.default_rng(0))
    image = renderers[focal].render(
        body,
        rng.normal(0.0, domain.speed, 3) * (1.0, 1.0, 0.3),
        rng.normal(0.0, 0.2, 3),
        rng.uniform(*domain.exposure),
        robots=robots,
    )
    tops = np.array([(it.north, it.east, -ROBOT.height) for it in robots]).reshape(-1, 3)
    eye = (body @ camera.mount).inverse()
    places = project(tops, eye, camera) if len(tops) else np.empty((0, 2))
    return RobotView(_lit(domain, image, rng), camera, body, robots, places)


def _robots(domain: Domain, body: Transform, rng: np.random.Generator) -> tuple[RobotLook, ...]:
    reach = 0.6 * float(-body.translation[2])
    robots: list[RobotLook] = []
    for _ in range(int(rng.integers(1, domain.robots + 1))):
        n, e = body.translation[:2] + rng.uniform(-reach, reach, 2)
        heading, plate = rng.uniform(-math.pi, math.pi), round(rng.uniform(*domain.plates))
        tower = rng.uniform(1.0, 2.0) if rng.random() < domain.towers else 0.0
        apart = all(math.hypot(n - it.north, e - it.east) > CLEAR for it in robots)
        if apart and tower < -body.translation[2] - 0.2:
            robots.append(RobotLook(float(n), float(e), float(heading), plate, float(tower)))
    return tuple(robots)


@functools.lru_cache(maxsize=64)
def _camera(focal: float, distortion: tuple[float, float, float, float, float]) -> CameraModel:
    mount = Mount(position=(0.0, 0.0, 0.0), tilt_deg=90.0)
    return Camera(width=320, height=240, focal=focal, distortion=distortion, mount=mount).model()


def _lit(domain: Domain, image: Image, rng: np.random.Generator) -> Image:
    """Return the picture in another light: brighter or darker, with a shadow's edge, softer."""
    rows, columns = np.mgrid[: image.shape[0], : image.shape[1]].astype(np.float32)
    light = np.full(image.shape, rng.uniform(*domain.light), np.float32)
    if rng.random() < domain.shadows:
        angle, soft = rng.uniform(-math.pi, math.pi), rng.uniform(0.7, 6.0)
        across = math.cos(angle) * (columns - rng.uniform(0, image.shape[1]))
        across += math.sin(angle) * (rows - rng.uniform(0, image.shape[0]))
        inside = 1.0 / (1.0 + np.exp(-np.clip(across / soft, -30, 30)))
        light *= 1.0 - (1.0 - rng.uniform(*domain.shadow)) * inside
    lit = np.clip(image.astype(np.float32) * light, 0, 255)
    blur = rng.uniform(*domain.blur)
    if blur > 0.2:
        softer = np.asarray(cv2.GaussianBlur(lit, (0, 0), blur), np.float32)
        lit = softer + 2.0 * rng.standard_normal(lit.shape, dtype=np.float32)
    return grey(lit)
