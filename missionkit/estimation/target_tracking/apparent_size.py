"""Telling an obstacle robot from a target by the size of its box.

Seen from a height h at a horizontal offset r, a tower of height t on the robot reaches out to
(r h + w/2 h) / (h - t) from below the camera, where the robot itself reaches to r + A/2. From
straight above it hides behind its own robot: then the size says nothing, and this says so.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Vec3

TOWERS = np.array((1.0, 1.25, 1.5, 1.75, 2.0))
"""Heights (m) of the towers, equally likely."""
TOWER_WIDTH = 0.1  # m
SIZE_SD = 0.1  # of a detector's boxes, relative
STRANGE = 0.02
"""Share of boxes that are of any size, whatever they show."""
LARGEST = 4.0
"""Times a robot's size; a larger box counts as one of this size."""


def sizes_of_obstacles(offset: float, height: float, diameter: float) -> Vec3:
    """Return the expected sizes of boxes around robots with each of the towers.

    Args:
        offset: m, horizontally from the camera.
        height: m, of the camera above the ground.
        diameter: m, of the robot.
    """
    return np.array([size_with_tower(offset, height, it, diameter) for it in TOWERS.tolist()])


def size_with_tower(offset: float, height: float, tower: float, diameter: float) -> float:
    """Return the size of the box around a robot with one tower.

    Args:
        offset: m, horizontally from the camera.
        height: m, of the camera above the ground.
        tower: m, height of its top; 0: none.
        diameter: m, of the robot.
    """
    if tower <= 0.0:
        return 1.0
    top = (offset + 0.5 * TOWER_WIDTH) * height / max(height - tower, 0.05) - offset
    return min(max(1.0, 0.5 + top / diameter), LARGEST)


def size_evidence(size: float, offset: float, height: float, diameter: float) -> float:
    """Return how much more likely a box is an obstacle robot's than a target's: a logarithm.

    Args:
        size: of the box, 1: that of a robot without a tower at this distance.
        offset: m, horizontally from the camera.
        height: m, of the camera above the ground.
        diameter: m, of the robot.
    """
    seen = min(size, LARGEST)
    expected = sizes_of_obstacles(offset, height, diameter)
    obstacle = float(np.mean(_density(seen, expected)))
    target = float(_density(seen, np.ones(1))[0])
    return math.log(_with_strange(obstacle) / _with_strange(target))


def _density(size: float, expected: Vec3) -> Vec3:
    sd = SIZE_SD * expected
    return np.asarray(np.exp(-0.5 * ((size - expected) / sd) ** 2) / (sd * math.sqrt(2 * math.pi)))


def _with_strange(density: float) -> float:
    return (1.0 - STRANGE) * density + STRANGE / LARGEST
