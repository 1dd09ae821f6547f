"""Flying round a sphere that must not be entered."""

from __future__ import annotations

import math

from missionkit.geometry import Vec3, across, cross, exp, norm, rotate

STEP = math.radians(20.0)  # along the sphere to the next point on the way
DEEP = 0.9  # share of the radius below which the way out comes first


def way_round(position: Vec3, goal: Vec3, centre: Vec3, radius: float) -> Vec3:
    """Return where to fly next so that the straight way there stays out of a sphere.

    The goal, if the way to it is free. Otherwise a point on a slightly larger sphere, ahead in
    the plane of position, goal and centre: from just within the sphere too, farther out, so that
    noise does not stop it on the way round. Deep within it, first straight out. A way may dip into
    the sphere by half a percent of its radius.

    Args:
        position: (3,), m.
        goal: (3,), m; inside the sphere it is reached from its own side only.
        centre: (3,), m, of the sphere.
        radius: m; 0: nothing is kept out of.
    """
    away, there = position - centre, goal - centre
    r, end = norm(away), norm(there)
    if radius <= 0.0 or r == 0.0 or end == 0.0 or _free(away, there, radius):
        return goal
    u, v = away / r, there / end
    if r < DEEP * radius:
        return centre + radius * u
    angle = math.atan2(norm(cross(u, v)), float(u @ v))
    ahead = math.acos(min(1.0, radius / r)) + STEP
    if ahead >= angle + STEP / 2.0:
        return goal if end >= radius else centre + radius * v
    larger = math.cos(STEP / 2.0) if r >= radius else math.cos(STEP)
    return centre + radius / larger * rotate(exp(min(ahead, angle) * _axis(u, v)), u)


def _free(away: Vec3, there: Vec3, radius: float) -> bool:
    """Say whether the way between two points, seen from the centre, stays out of the sphere."""
    way = there - away
    length = float(way @ way)
    if length == 0.0:
        return True
    nearest = away + min(1.0, max(0.0, -float(away @ way) / length)) * way
    return norm(nearest) >= min(0.999 * radius, norm(there), norm(away))


def _axis(u: Vec3, v: Vec3) -> Vec3:
    """Return the unit axis that turns u into v; any across u if they are opposite."""
    axis = cross(u, v)
    size = norm(axis)
    return across(u) if size < 1e-6 else axis / size
