"""A flat world of round and square obstacles, a 72-ray scanner, and a vehicle with lag."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.geometry import IDENTITY, Vec3, norm
from missionkit.messages import Estimate, Health
from missionkit.planning.potential_field import PotentialField

HEALTH = Health(True, False, 0.0, 0.0, 0.1, 0)
RANGE = 12.0  # m
DT = 0.05  # s


class Cylinder(NamedTuple):
    north: float
    east: float
    radius: float

    def clearance(self, p: Vec3) -> float:
        return math.hypot(p[0] - self.north, p[1] - self.east) - self.radius

    def hit(self, p: Vec3, rays: np.ndarray) -> np.ndarray:
        to = np.array([self.north - p[0], self.east - p[1]])
        along = rays @ to
        root = self.radius**2 - to @ to + along**2
        return np.where((root > 0) & (along > 0), along - np.sqrt(np.maximum(root, 0)), np.inf)


class Box(NamedTuple):
    low: tuple[float, float]
    high: tuple[float, float]

    def clearance(self, p: Vec3) -> float:
        gap = np.maximum(np.maximum(np.subtract(self.low, p[:2]), p[:2] - self.high), 0.0)
        return float(np.hypot(*gap))

    def hit(self, p: Vec3, rays: np.ndarray) -> np.ndarray:
        with np.errstate(divide="ignore"):
            one = (np.array(self.low) - p[:2]) / rays
            other = (np.array(self.high) - p[:2]) / rays
        enter = np.minimum(one, other).max(axis=1)
        leave = np.maximum(one, other).min(axis=1)
        return np.where((enter > 0) & (enter < leave), enter, np.inf)


Obstacles = tuple[Cylinder | Box, ...]


def scan(p: Vec3, obstacles: Obstacles) -> np.ndarray:
    angles = np.deg2rad(np.arange(72) * 5.0) + 0.01
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    reach = np.min([o.hit(p, rays) for o in obstacles], axis=0)
    seen = reach < RANGE
    return np.column_stack([p[:2] + rays[seen] * reach[seen, None], np.full(seen.sum(), p[2])])


class Flight(NamedTuple):
    arrived: float  # s, inf when it did not
    clearance: float  # m, least distance of the vehicle's centre from a surface
    path: np.ndarray


def estimate(now: float, p: Vec3, v: Vec3, points: np.ndarray | None) -> Estimate:
    at = None if points is None else now
    return Estimate(
        now, p, v, IDENTITY, np.zeros(3), HEALTH, obstacles=points, scanned_at=at, scan_range=RANGE
    )


def fly(
    field: PotentialField, obstacles: Obstacles, goal: Vec3, speed: float = 5.0, until: float = 90.0
) -> Flight:
    """First order velocity loop (0.3 s) behind 0.1 s of latency, at most 3 m/s², scans at 10 Hz."""
    p, v = np.array([0.0, 0.0, -3.0]), np.zeros(3)
    memory, pipe, path = field.begin(), [np.zeros(3)] * 2, []
    for k in range(int(until / DT)):
        points = scan(p, obstacles) if k % 2 == 0 else None
        wanted = goal - p
        wanted = wanted * min(1.0, speed / max(norm(wanted), 1e-9))
        push, memory = field.step(memory, estimate(k * DT, p, v, points), goal, wanted)
        pipe.append(wanted + push)
        pull = (pipe.pop(0) - v) / 0.3
        v = v + DT * pull * min(1.0, 3.0 / max(norm(pull), 1e-9))
        p = p + DT * v
        path.append(p)
        if norm(goal - p) < 0.3:
            break
    least = min(o.clearance(q) for q in path for o in obstacles)
    arrived = len(path) * DT if norm(goal - p) < 0.3 else math.inf
    return Flight(arrived, least, np.array(path))
