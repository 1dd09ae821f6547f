"""The solid things of a world, made ready for drawing."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple, assert_never

import numpy as np
import numpy.typing as npt

from missionkit.geometry import Vec3, to_matrix, vec
from missionkit.messages import Image, Points
from missionkit.sim import textures
from missionkit.sim.arena import Arena
from missionkit.sim.deck import THICK
from missionkit.sim.perspective_canvas import Face, Hull
from missionkit.sim.world import Box, Cylinder, Marker, Obstacle, Sphere, World

TRUNK_CORNERS, BALL_CORNERS = 16, 40  # of a round outline
TRUNK = 10.24  # m, height of the bark texture
EDGE = 0.1  # m, width of the lines around an arena
GOAL_LINE, EDGE_LINE = 245, 195  # grey levels
GRAIN = 0.01  # m, a texel of plaster

Faces = Callable[[Vec3], list[Face]]


class Solid(NamedTuple):
    """A convex body and the faces to be painted, back to front, for an eye (3,), NED."""

    hull: Hull
    normals: Points  # (K, 3), unit: planes that may part it from others
    faces: Faces
    marker: int | None = None

    @property
    def centre(self) -> Vec3:
        """Mean of the corners, (3,), m, NED."""
        return np.asarray(self.hull.points.mean(axis=0))


def solids(world: World) -> list[Solid]:
    """Return every obstacle and marker of a world.

    Raises:
        UsageError: a marker's dictionary or id does not exist.
    """
    return [*map(obstacle, world.obstacles), *map(marker, world.markers)]


def deck_solids(world: World) -> list[Solid]:
    """Return the deck of a world, then the markers on it, where they are at the start."""
    deck = world.deck
    if deck is None:
        return []
    (north, east), half = deck.at, 0.5 * deck.size
    slope_n, slope_e = deck.slope
    ring = [(-half, -half), (-half, half), (half, half), (half, -half)]
    top = np.array(
        [(north + n, east + e, slope_n * n + slope_e * e - deck.height) for n, e in ring]
    )
    low = top + vec(0.0, 0.0, THICK)
    edges = prism(top[:, :2], 0.0, 0.0).edges
    sides = [(top[i], top[(i + 1) % 4], low[i]) for i in range(4)]
    sides += [(top[3], top[2], top[0]), (low[0], low[1], low[3])]
    slab = _block(Hull(np.vstack([top, low]), edges), sides)
    return [slab, *map(marker, world.deck_markers)]


def moved(solid: Solid, shift: Vec3) -> Solid:
    """Return a solid `shift` (3,), m, NED, away."""

    def faces(eye: Vec3) -> list[Face]:
        return [
            face._replace(origin=face.origin + shift, hull=_moved(face.hull, shift))
            for face in solid.faces(eye - shift)
        ]

    return Solid(_moved(solid.hull, shift), solid.normals, faces, solid.marker)


def _moved(hull: Hull, shift: Vec3) -> Hull:
    return Hull(hull.points + shift, hull.edges)


def obstacle(of: Obstacle) -> Solid:
    """Return an obstacle as a solid."""
    match of:
        case Cylinder():
            return _cylinder(of)
        case Box():
            return _box(of)
        case Sphere():
            return _sphere(of)
        case _:
            assert_never(of)


def marker(of: Marker) -> Solid:
    """Return a marker as a board with a plain back."""
    front, ratio = textures.board(of.dictionary, of.id)
    right, up, out = to_matrix(of.attitude).T
    centre = vec(*of.position)
    side = of.size * ratio
    half = 0.5 * side
    corner = centre - half * right + half * up
    points = np.array([corner, corner + side * right, corner + side * (right - up), corner])
    points[3] -= side * up
    hull = ring_of(points)
    back = textures.pyramid(np.full((8, 8), 92, np.uint8))

    def faces(eye: Vec3) -> list[Face]:
        seen = front if (eye - centre) @ out > 0 else back
        border = textures.WHITE if seen is front else 92
        return [Face(corner, side * right, -side * up, seen, hull, border, fine=True)]

    return Solid(hull, out[None, :], faces, of.id)


def edge_lines(arena: Arena) -> tuple[Face, ...]:
    """Return the lines around an arena, painted inside it: the goal's is the brightest.

    Args:
        arena: of the world.
    """
    (n, e), half = arena.centre, 0.5 * arena.side
    n0, n1, e0, e1 = n - half, n + half, e - half, e + half
    strips = {
        "south": (n0, n0 + EDGE, e0, e1),
        "north": (n1 - EDGE, n1, e0, e1),
        "west": (n0, n1, e0, e0 + EDGE),
        "east": (n0, n1, e1 - EDGE, e1),
    }
    return tuple(
        _strip(*strip, GOAL_LINE if side == arena.goal else EDGE_LINE)
        for side, strip in strips.items()
    )


def _strip(south: float, north: float, west: float, east: float, level: int) -> Face:
    corners = [(north, west), (north, east), (south, east), (south, west)]
    hull = ring_of(np.array([(n, e, 0.0) for n, e in corners]))
    paint = textures.pyramid(np.full((8, 8), level, np.uint8))
    across, down = vec(0.0, east - west, 0.0), vec(south - north, 0.0, 0.0)
    return Face(vec(north, west, 0.0), across, down, paint, hull, level)


def ring_of(points: Points) -> Hull:
    """Return a flat convex polygon."""
    order = np.arange(len(points))
    return Hull(points, np.stack([order, np.roll(order, -1)], axis=1))


def prism(base: npt.NDArray[np.float64], top: float, bottom: float) -> Hull:
    """Return an upright prism.

    Args:
        base: (N, 2), m, north and east of its corners.
        top: m, down.
        bottom: m, down.
    """
    n = len(base)
    points = np.vstack([np.column_stack([base, np.full(n, z)]) for z in (top, bottom)])
    i = np.arange(n)
    j = np.roll(i, -1)
    edges = np.vstack([np.stack(pair, axis=1) for pair in ((i, j), (i + n, j + n), (i, i + n))])
    return Hull(points, edges)


def circle(radius: float, corners: int) -> npt.NDArray[np.float64]:
    """Return a regular polygon (corners, 2) with the area of a circle."""
    step = 2 * math.pi / corners
    angle = step * np.arange(corners)
    fair = radius * math.sqrt(step / math.sin(step))
    return np.stack([fair * np.cos(angle), fair * np.sin(angle)], axis=1)


def _plain(brightness: float, normal: Sequence[float]) -> tuple[Image, ...]:
    level = brightness * textures.shade(np.array([normal]))
    return textures.pyramid(np.full((8, 8), textures.grey(level)[0], np.uint8))


def _cylinder(of: Cylinder) -> Solid:
    """A trunk: an upright board between its tangent points, painted over its silhouette."""
    north, east = of.at
    ring = circle(of.radius, TRUNK_CORNERS) + np.array(of.at)
    hull = prism(ring, -of.height, 0.0)
    cap = ring_of(hull.points[:TRUNK_CORNERS])
    wood = _plain(120, (0.0, 0.0, -1.0))
    r, tall = of.radius, max(TRUNK, of.height)
    sunk = vec(0.0, 0.0, tall + r)  # the front of the foot lies below the board's own foot
    rim = vec(north - r, east - r, -of.height)

    def faces(eye: Vec3) -> list[Face]:
        dn, de = eye[0] - north, eye[1] - east
        gap = math.hypot(dn, de)
        painted = []
        if gap > 1.001 * r:
            c, s = dn / gap, de / gap
            half, ahead = r * math.sqrt(1 - (r / gap) ** 2), r * r / gap
            right = vec(s, -c, 0.0)
            left = vec(north + ahead * c, east + ahead * s, -tall) - half * right
            drawn = textures.bark()[textures.sector(math.atan2(de, dn))]
            foot = int(drawn[0][-1].mean())
            painted.append(Face(left, 2 * half * right, sunk, drawn, hull, foot))
        if eye[2] < -of.height:
            along, over = vec(2 * r, 0.0, 0.0), vec(0.0, 2 * r, 0.0)
            painted.append(Face(rim, along, over, wood, cap, int(wood[0][0, 0])))
        return painted

    return Solid(hull, np.array([[0.0, 0.0, 1.0]]), faces)


def _box(of: Box) -> Solid:
    """A building: the sides that face the eye, each with its own brightness."""
    (n0, e0), (n1, e1) = of.min, of.max
    base = np.array([[n0, e0], [n0, e1], [n1, e1], [n1, e0]])
    hull = prism(base, -of.height, -of.bottom)
    top, low = hull.points[:4], hull.points[4:]
    # each side by its top left, top right and bottom left corner, as seen from outside
    sides = [(top[i], top[(i + 1) % 4], low[i]) for i in range(4)]
    sides += [(top[3], top[2], top[0]), (low[0], low[1], low[3])]
    return _block(hull, sides)


def _block(hull: Hull, sides: Sequence[tuple[Vec3, Vec3, Vec3]]) -> Solid:
    """Return a block of plaster.

    Args:
        hull: of it.
        sides: each by its top left, top right and bottom left corner, as seen from outside.
    """
    built = [_side(*corners) for corners in sides]

    def faces(eye: Vec3) -> list[Face]:
        return [face for face, normal in built if (eye - face.origin) @ normal > 1e-3]

    return Solid(hull, np.array([normal for _, normal in built]), faces)


def _side(left: Vec3, right: Vec3, below: Vec3) -> tuple[Face, Vec3]:
    """Return a rectangle of wall and its outward normal (3,)."""
    across, down = right - left, below - left
    width, height = np.linalg.norm(across), np.linalg.norm(down)
    normal = np.cross(down, across) / (width * height)
    grain = max(GRAIN, float(max(width, height)) / 1024)
    rows, columns = (max(4, round(float(side) / grain)) for side in (height, width))
    wall = textures.plaster()
    tiled = wall[np.arange(-rows, 0) % 512][:, np.arange(columns) % 512]
    lit = textures.grey(tiled * textures.shade(normal))
    hull = ring_of(np.array([left, right, right + down, below]))
    return Face(left, across, down, textures.pyramid(lit), hull, int(lit.mean())), normal


def _sphere(of: Sphere) -> Solid:
    """A ball: a disc through its tangent points, square to the line of sight."""
    centre, r = vec(*of.at), of.radius
    grid = np.array([[n, e, d] for n in (-r, r) for e in (-r, r) for d in (-r, r)])
    hull = Hull(centre + grid, np.zeros((0, 2), np.intp))
    ring = np.column_stack([circle(1.0, BALL_CORNERS), np.zeros(BALL_CORNERS)])

    def faces(eye: Vec3) -> list[Face]:
        sight = eye - centre
        gap = float(np.linalg.norm(sight))
        if gap <= 1.001 * r:
            return []
        sight = sight / gap
        flat = math.hypot(sight[0], sight[1])
        right = vec(sight[1], -sight[0], 0.0) / flat if flat > 1e-6 else vec(0.0, 1.0, 0.0)
        below = np.cross(right, sight)
        half = r * math.sqrt(1 - (r / gap) ** 2)
        middle = centre + r * r / gap * sight
        disc = ring_of(middle + half * ring @ np.array([right, below, sight]))
        drawn = textures.foliage()[textures.sector(math.atan2(sight[1], sight[0]))]
        corner = middle - half * (right + below)
        return [Face(corner, 2 * half * right, 2 * half * below, drawn, disc, 60)]

    return Solid(hull, np.eye(3), faces)
