"""Distances and rays against the obstacles of a world.

Imported late: it compiles kernels. An obstacle is a row of eight numbers: kind (0 cylinder, 1 box,
2 sphere), then cylinder: n, e, radius, -, bottom, top; box: south, west, north, east, bottom, top;
sphere: n, e, height, radius. Bottom, top and height are above the ground (m).
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled
from missionkit.sim.world import Box, Cylinder, World

CYLINDER_ROW, BOX_ROW, SPHERE_ROW = 0.0, 1.0, 2.0


def table(world: World) -> Mat:
    """Return the obstacles of `world` as rows (N, 8)."""
    rows = np.zeros((len(world.obstacles), 8))
    for row, thing in zip(rows, world.obstacles, strict=True):
        if isinstance(thing, Cylinder):
            row[:7] = (CYLINDER_ROW, *thing.at, thing.radius, 0.0, 0.0, thing.height)
        elif isinstance(thing, Box):
            row[:7] = (BOX_ROW, *thing.min, *thing.max, thing.bottom, thing.height)
        else:
            row[:5] = (SPHERE_ROW, thing.at[0], thing.at[1], -thing.at[2], thing.radius)
    return rows


@compiled
def gap(thing: Vec3, n: float, e: float, height: float) -> float:
    """Return the signed distance (m) from a point to one obstacle, negative inside.

    Args:
        thing: row of the obstacle.
        n: m, north.
        e: m, east.
        height: m above the ground.
    """
    if thing[0] == SPHERE_ROW:
        dn, de, du = n - thing[1], e - thing[2], height - thing[3]
        return float(math.sqrt(dn * dn + de * de + du * du) - thing[4])
    up = max(thing[5] - height, height - thing[6])
    if thing[0] == CYLINDER_ROW:
        side = math.sqrt((n - thing[1]) ** 2 + (e - thing[2]) ** 2) - thing[3]
        other = side
    else:
        side = max(thing[1] - n, n - thing[3])
        other = max(thing[2] - e, e - thing[4])
    if side <= 0.0 and other <= 0.0 and up <= 0.0:
        return float(max(side, other, up))
    a, b, c = max(side, 0.0), max(other, 0.0), max(up, 0.0)
    if thing[0] == CYLINDER_ROW:
        b = 0.0
    return math.sqrt(a * a + b * b + c * c)


@compiled
def nearest_gap(things: Mat, n: float, e: float, height: float) -> float:
    """Return the signed distance (m) to the nearest obstacle; infinite if there is none.

    Args:
        things: (n, ·) obstacles, a row each.
        n: m, north.
        e: m, east.
        height: m above the ground.
    """
    least = math.inf
    for row in range(things.shape[0]):
        least = min(least, gap(things[row], n, e, height))
    return least


@compiled
def slab(start: float, way: float, low: float, high: float) -> tuple[float, float]:
    """Return where a ray enters and leaves low <= x <= high along one axis (Kay and Kajiya).

    Args:
        start: of the ray, along the axis (m).
        way: of the unit direction, along the axis.
        low: m.
        high: m.
    """
    if abs(way) < 1e-12:
        inside = low <= start <= high
        return (-math.inf, math.inf) if inside else (math.inf, -math.inf)
    a, b = (low - start) / way, (high - start) / way
    return min(a, b), max(a, b)


@compiled
def ball(
    sn: float, se: float, su: float, wn: float, we: float, wu: float, radius: float
) -> tuple[float, float]:
    """Return where a ray from s along w enters and leaves |x| <= radius.

    Args:
        sn: m, north of the start from the centre.
        se: m, east.
        su: m, up.
        wn: north of the unit direction.
        we: east.
        wu: up.
        radius: m.
    """
    a = wn * wn + we * we + wu * wu
    b = sn * wn + se * we + su * wu
    c = sn * sn + se * se + su * su - radius * radius
    if a < 1e-12:
        return (-math.inf, math.inf) if c <= 0.0 else (math.inf, -math.inf)
    root = b * b - a * c
    if root < 0.0:
        return math.inf, -math.inf
    root = math.sqrt(root)
    return (-b - root) / a, (-b + root) / a


@compiled
def hit(thing: Vec3, start: Vec3, way: Vec3) -> float:
    """Return how far along a ray one obstacle begins; infinite when it is missed.

    Args:
        thing: (8,) obstacle.
        start: (3,) m, NED.
        way: (3,) unit vector, NED.
    """
    if thing[0] == SPHERE_ROW:
        dn, de, du = start[0] - thing[1], start[1] - thing[2], -start[2] - thing[3]
        enter, leave = ball(dn, de, du, way[0], way[1], -way[2], thing[4])
    else:
        enter, leave = slab(-start[2], -way[2], thing[5], thing[6])
        if thing[0] == CYLINDER_ROW:
            dn, de = start[0] - thing[1], start[1] - thing[2]
            a, b = ball(dn, de, 0.0, way[0], way[1], 0.0, thing[3])
            enter, leave = max(enter, a), min(leave, b)
        else:
            for axis in range(2):
                a, b = slab(start[axis], way[axis], thing[1 + axis], thing[3 + axis])
                enter, leave = max(enter, a), min(leave, b)
    if enter > leave or leave < 0.0:
        return math.inf
    return max(0.0, enter)


@compiled
def cast(things: Mat, start: Vec3, way: Vec3) -> float:
    """Return the distance (m) along a ray to the first obstacle; infinite if there is none.

    Args:
        things: (n, ·) obstacles, a row each.
        start: (3,), m.
        way: (3,), unit vector.
    """
    least = math.inf
    for row in range(things.shape[0]):
        least = min(least, hit(things[row], start, way))
    return least


@compiled
def ring(things: Mat, start: Vec3, yaw: float, reach: float, noise: Vec3) -> Mat:
    """Return one levelled scan: the points (N, 3), m, NED offsets from `start`, in heading order.

    Args:
        things: (M, 8) obstacles.
        start: (3,) m, NED.
        yaw: rad, direction of the first ray.
        reach: m, farther surfaces are not seen.
        noise: (K,) m, added to the distance of each of the K rays round the circle.
    """
    count = noise.shape[0]
    points = np.empty((count, 3))
    way = np.zeros(3)
    near = np.empty_like(things)
    within = 0
    for row in range(things.shape[0]):
        if gap(things[row], start[0], start[1], -start[2]) <= reach:
            for n in range(things.shape[1]):
                near[within, n] = things[row, n]
            within += 1
    near = near[:within]
    found = 0
    for n in range(count):
        angle = yaw + n * (2.0 * math.pi / count)
        way[0], way[1] = math.cos(angle), math.sin(angle)
        far = cast(near, start, way)
        if far <= reach:
            far = max(0.0, far + noise[n])
            points[found, 0], points[found, 1], points[found, 2] = far * way[0], far * way[1], 0.0
            found += 1
    return points[:found]
