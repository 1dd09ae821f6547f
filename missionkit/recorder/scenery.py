"""Scenery for the picture and the 3D view: obstacles, markers, targets, fences."""

from __future__ import annotations

import math
from typing import Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from missionkit.chart.checks.geofence_violations import walls
from missionkit.chart.model.mission import Mission
from missionkit.geometry import IDENTITY, Quat, Vec3, rotate, vec
from missionkit.recorder import json_fragments
from missionkit.states import VEHICLES

Ground = npt.NDArray[np.float64]  # (N, 2), m, north and east
Spot = tuple[float, float]  # m, north and east

BARK = json_fragments.colour(0.45, 0.35, 0.25, 0.9)
PAPER = json_fragments.colour(0.95, 0.95, 0.95)


class Round(NamedTuple):
    """An upright cylinder, or a ball when `ball`."""

    at: Spot
    radius: float  # m
    bottom: float  # m above the ground
    top: float  # m above the ground
    ball: bool = False

    def footprint(self) -> Ground:
        """Return the outline (N, 2), m, north and east."""
        turn = np.linspace(0.0, 2.0 * math.pi, 37)
        return np.asarray(self.at) + self.radius * np.column_stack([np.cos(turn), np.sin(turn)])


class DrawnBox(NamedTuple):
    """A box with its sides along north and east."""

    low: Spot
    high: Spot
    bottom: float  # m above the ground
    top: float  # m above the ground

    def footprint(self) -> Ground:
        """Return the outline (5, 2), m, north and east."""
        (n0, e0), (n1, e1) = self.low, self.high
        return np.array([(n0, e0), (n1, e0), (n1, e1), (n0, e1), (n0, e0)])


class DrawnMarker(NamedTuple):
    """A square marker."""

    name: str
    position: Vec3  # (3,), m, NED, of its centre
    attitude: Quat  # marker axes (x right, y up, z towards the viewer) to world
    size: float  # m, side

    @property
    def normal(self) -> Vec3:
        """Where it faces, (3,), unit length, NED."""
        return rotate(self.attitude, vec(0.0, 0.0, 1.0))


class DrawnTarget(NamedTuple):
    """Where the mission file says that a target is."""

    name: str
    at: Spot


class Fence(NamedTuple):
    """Lines on the ground (m, north and east) at which a failsafe acts."""

    corners: tuple[Spot, ...]
    holes: tuple[tuple[Spot, ...], ...] = ()

    @classmethod
    def box(cls, north: tuple[float, float], east: tuple[float, float]) -> Fence:
        """Return the fence between two norths and two easts (m)."""
        (south, top), (west, right) = north, east
        return cls(((south, west), (top, west), (top, right), (south, right)))

    def outline(self) -> Ground:
        """Return the corners (N, 2), m, north and east."""
        return np.array(self.corners)


class DrawnArena(NamedTuple):
    """Where ground robots are in play."""

    outline: Ground  # (4, 2), m
    goal: Ground  # (2, 2), m, ends of the goal's side


class RobotPath(NamedTuple):
    """Where a ground robot really drove."""

    places: Ground  # (N, 2), m
    kind: Literal["target", "obstacle"]
    end: Literal["", "home", "lost"] = ""


class Scenery(NamedTuple):
    """Everything in the world, and the mission's places in it."""

    obstacles: tuple[Round | DrawnBox, ...] = ()
    markers: tuple[DrawnMarker, ...] = ()
    targets: tuple[DrawnTarget, ...] = ()
    fences: tuple[Fence, ...] = ()
    arena: DrawnArena | None = None
    paths: tuple[RobotPath, ...] = ()
    over_ground: bool = True  # north, east and down from take-off; else x, y, z of a mother-ship


def scenery_of(world: Any, mission: Mission | None = None) -> Scenery:
    """Read obstacles and markers from a simulator's world, targets and fences from a mission.

    Args:
        world: has `obstacles`, each with `use` (cylinder, box or sphere) and its measures, and
            `markers`, each with `id`, `size`, `position` and `attitude`; perhaps an `arena` with
            `centre`, `side` and `goal`.
        mission: with the targets and the failsafes that keep fences.
    """
    targets = {} if mission is None else mission.targets
    fences = () if mission is None else walls(mission)
    return Scenery(
        tuple(map(_obstacle, world.obstacles)),
        tuple(
            DrawnMarker(f"marker {it.id}", vec(*it.position), it.attitude, it.size)
            for it in getattr(world, "all_markers", world.markers)
        ),
        tuple(DrawnTarget(name, it.position[:2]) for name, it in targets.items()),
        tuple(
            dict.fromkeys(
                Fence(it.outline(), tuple(hole.polygon for hole in it.holes)) for it in fences
            )
        ),
        _arena(getattr(world, "arena", None)),
        over_ground=mission is None or VEHICLES[mission.vehicle.use].over_ground,
    )


def _arena(it: Any) -> DrawnArena | None:
    if it is None:
        return None
    (n, e), half = it.centre, 0.5 * it.side
    corners = np.array(
        [(n - half, e - half), (n + half, e - half), (n + half, e + half), (n - half, e + half)]
    )
    first = ("west", "north", "east", "south").index(it.goal)
    return DrawnArena(corners, np.roll(corners, -first, axis=0)[:2])


def _obstacle(it: Any) -> Round | DrawnBox:
    if it.use == "box":
        return DrawnBox(it.min, it.max, it.bottom, it.height)
    if it.use == "sphere":
        north, east, down = it.at
        return Round((north, east), it.radius, -down - it.radius, -down + it.radius, ball=True)
    return Round(it.at, it.radius, 0.0, it.height)


def scene_update(scenery: Scenery, at: str, frame: str) -> str:
    """Return the world as one `foxglove.SceneUpdate`.

    Args:
        scenery: m, NED.
        at: JSON of the time.
        frame: id of the frame in which the scenery stands.
    """
    round_ones = [it for it in scenery.obstacles if isinstance(it, Round)]
    balls = [_solid(*_round(it)) for it in round_ones if it.ball]
    cylinders = [_cylinder(it) for it in round_ones if not it.ball]
    cubes = [_box(it) for it in scenery.obstacles if isinstance(it, DrawnBox)]
    cubes += [_marker(it) for it in scenery.markers]
    return (
        f'{{"deletions":[],"entities":[{{"timestamp":{at},"frame_id":"{frame}","id":"world",'
        '"lifetime":{"sec":0,"nsec":0},"frame_locked":false,"metadata":[],"arrows":[],'
        f'"cubes":[{",".join(cubes)}],"spheres":[{",".join(balls)}],'
        f'"cylinders":[{",".join(cylinders)}],"lines":[],"triangles":[],"texts":[],"models":[]}}]}}'
    )


def _round(it: Round) -> tuple[str, Vec3]:
    """Return pose and extent."""
    middle = vec(*it.at, -0.5 * (it.bottom + it.top))
    size = vec(2.0 * it.radius, 2.0 * it.radius, it.top - it.bottom)
    return json_fragments.pose(middle, IDENTITY), size


def _cylinder(it: Round) -> str:
    pose, size = _round(it)
    return (
        f'{{"pose":{pose},"size":{json_fragments.vector(size)},"bottom_scale":1,"top_scale":1,'
        f'"color":{BARK}}}'
    )


def _box(it: DrawnBox) -> str:
    (n0, e0), (n1, e1) = it.low, it.high
    middle = vec(0.5 * (n0 + n1), 0.5 * (e0 + e1), -0.5 * (it.bottom + it.top))
    return _solid(json_fragments.pose(middle, IDENTITY), vec(n1 - n0, e1 - e0, it.top - it.bottom))


def _marker(it: DrawnMarker) -> str:
    return _solid(json_fragments.pose(it.position, it.attitude), vec(it.size, it.size, 0.02), PAPER)


def _solid(pose: str, size: Vec3, colour: str = BARK) -> str:
    return f'{{"pose":{pose},"size":{json_fragments.vector(size)},"color":{colour}}}'
